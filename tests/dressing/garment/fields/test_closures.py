"""Closures of patterns: where their pairs lie, keys of scene files, mistakes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.dressing.garment.fields.test_mesh_parts import EDGES, meshed, pattern
from toile.dressing.garment.fabrics import fabric
from toile.dressing.garment.fields.closure import Closure
from toile.dressing.garment.fields.field import Parts
from toile.dressing.garment.fields.mesh_parts import parts_on_mesh
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.run.scene_file import load_scene
from toile.dressing.wear.assemble_cloth import assemble_cloth
from toile.engine.cloth.fields.keyed import Keyed
from toile.geometry.errors import InputError


def closure(**given: Any) -> Closure:
    usual: dict[str, Any] = {"kind": "buttons", "over": "right.1", "under": "left.3", "count": 3}
    return Closure(**(usual | given))


def test_buttons_lie_inside_of_their_edges_opposite_each_other() -> None:
    """Right.1 is walked up at x = 0.4, left.3, whose loop goes down, against it, up at x = 0."""
    mesh = meshed(closures=(closure(inset=0.02, ends=0.05),))
    (row,) = assemble_cloth([(mesh, fabric("cotton-poplin"))], [np.empty(0, np.int32)]).fastenings
    assert row.over == (0, 1) and row.under == (0, 0) and row.side == 1
    assert row.over_points == pytest.approx(np.array([(0.38, y, 0.0) for y in (0.05, 0.15, 0.25)]))
    assert row.under_points == pytest.approx(np.array([(0.02, y, 0.0) for y in (0.05, 0.15, 0.25)]))


def test_turned_edges_begin_at_the_other_end_and_keep_their_inside() -> None:
    mesh = meshed(closures=(closure(over="-right.1", under="-left.3", inset=0.02, wrong_side=True),))
    (row,) = mesh.fastenings
    assert row.over_points[:, 1] == pytest.approx([0.25, 0.15, 0.05]) and row.side == -1
    assert row.under_points[:, 1] == pytest.approx([0.25, 0.15, 0.05])
    assert row.over_points[:, 0] == pytest.approx(0.38) and row.under_points[:, 0] == pytest.approx(0.02)


def test_a_zip_runs_along_parts_of_edges_with_its_strength_per_length() -> None:
    zipped = closure(
        kind="zip", over="right.1[0.2:0.8]", under="left.3[0.2:0.8]", count=None, stiffness=1e5, most=500.0
    )
    (row,) = meshed(closures=(zipped,)).fastenings
    assert row.side == 0 and len(row.over_points) == 36
    assert row.over_points[:, 1].min() == pytest.approx(0.0625) and row.over_points[:, 0] == pytest.approx(
        0.4
    )
    assert row.stiffness.sum() == pytest.approx(1e5 * 0.18) and row.most.sum() == pytest.approx(500.0 * 0.18)


def test_keys_of_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        '[[garment]]\nsource = "tshirt"\n[[garment.closure]]\nkind = "zip"\nover = "a.1"\nunder = "b.2"\n'
        "closed = { times = [0, 1], values = [1, 0.3] }\n"
    )
    (found,) = load_scene(path).garments[0].closures
    assert found == Closure(kind="zip", over="a.1", under="b.2", closed=Keyed((0, 1), (1, 0.3)))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"kind": "velcro"}, "kind must be one of buttons, snaps, zip"),
        ({"count": None}, "count of buttons must be a whole number"),
        ({"kind": "zip"}, "a zip runs along its edges"),
        ({"closed": 1.5}, "closed must lie between 0 and 1"),
        ({"over": "right.7"}, "panel 'right' has no edge 7"),
        ({"under": "left.0"}, "name edges, or parts of edges, of one length"),
        ({"ends": 0.2}, "ends of 20.0 cm do not fit"),
        ({"over": "waist"}, "must be edges of one panel"),
        ({"over": "right.0 + right.2"}, "do not follow each other"),
        ({"over": "sleeve"}, "sleeve"),
    ],
)
def test_mistakes_are_told_in_a_line(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        meshed(closures=(closure(**given),))
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_meshes_have_no_numbered_edges() -> None:
    from dataclasses import replace

    mesh = replace(mesh_pattern(pattern(), edge_length=EDGES.length), borders=())
    with pytest.raises(InputError, match="needs a pattern"):
        parts_on_mesh(mesh, Parts(closures=(closure(),)), 24.0)
