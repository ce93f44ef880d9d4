"""Which edges of a garment keep it in its place while it is put on."""

from dataclasses import replace

import numpy as np
import pytest

from tests.dressing.wear.test_start_repair import panels
from toile.dressing.garment.fabrics import fabric
from toile.dressing.pattern.roles import EdgeRole
from toile.dressing.wear.assemble_cloth import assemble_cloth
from toile.geometry.arrays import Int

UPPER, LOWER = np.array([2, 3], np.int32), np.array([0, 1], np.int32)


@pytest.mark.parametrize(
    ("edges", "held", "waist"),
    [
        ({}, [], []),
        ({"waist": UPPER}, [2, 3], [2, 3]),
        ({"strapless_top": UPPER, "waist": LOWER}, [0, 1, 2, 3], [0, 1, 2, 3]),
        ({"collar": UPPER, "waist": LOWER}, [0, 1, 2, 3], []),
        ({"armhole": UPPER, "strapless_top": LOWER}, [0, 1, 2, 3], []),
    ],
)
def test_what_sits_on_the_body_is_held_there(
    edges: dict[EdgeRole, Int], held: list[int], waist: list[int]
) -> None:
    """But not where it hangs from the shoulders; another garment on the same body makes no difference."""
    mesh, shirt = replace(panels(0.2, 0.3), edges=edges), replace(panels(0.2, 0.4), edges={"collar": UPPER})
    poplin = fabric("cotton-poplin")
    cloth = assemble_cloth([(mesh, poplin), (shirt, poplin)], [])
    assert cloth.held.tolist() == [*held, 6, 7]
    assert cloth.waist.tolist() == waist


def test_labels_hold_but_do_not_say_where() -> None:
    mesh = replace(panels(0.2, 0.3), held={"lower_interface": UPPER})
    cloth = assemble_cloth([(mesh, fabric("cotton-poplin"))], [])
    assert (cloth.held.tolist(), cloth.waist.tolist()) == ([2, 3], [])
