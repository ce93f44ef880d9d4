"""Patches of patterns: where they start and are sewn, mistakes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.dressing.garment.fields.test_mesh_parts import meshed
from toile.dressing.garment.fields.patch import AHEAD, APART, Patch
from toile.dressing.run.scene_file import load_scene
from toile.geometry.errors import InputError


def patch(**given: Any) -> Patch:
    usual: dict[str, Any] = {"run": "left.0[0:0.5]", "onto": "right", "at": (0.05, 0.02)}
    return Patch(**(usual | given))


def test_a_patch_starts_in_front_of_what_it_lies_on_and_is_sewn_where_it_lies() -> None:
    """Panels lie in the plane x, y, right sides towards +z; turned by 90 degrees up is to the left."""
    mesh = meshed(patches=(patch(at=(0.35, 0.05), turn=90.0),))
    own = np.unique(mesh.faces[mesh.panel == 0])
    u, v = mesh.uv[own].T
    wanted = np.column_stack([0.5 + 0.35 - v, 0.05 + u, np.full(len(own), AHEAD)])
    assert mesh.positions[own] == pytest.approx(wanted, abs=1e-9)
    (row,) = mesh.fastenings
    assert row.over == (0, 0) and row.under == (0, 1) and row.side == 1 and row.distance == APART
    assert len(row.over_points) == 26
    assert (
        row.over_points[:, 0] == pytest.approx(np.linspace(0.0, 0.2, 26)) and not row.over_points[:, 1].any()
    )
    assert row.under_points[:, 1] == pytest.approx(0.05 + row.over_points[:, 0])
    assert row.under_points[:, 0] == pytest.approx(0.35)


def test_keys_of_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        '[[garment]]\nsource = "a.json"\n[[garment.patch]]\nrun = "p.0"\nonto = "front"\nat = [0.1, 0.2]\n'
    )
    assert load_scene(path).garments[0].patches == (Patch(run="p.0", onto="front", at=(0.1, 0.2)),)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"onto": "rihgt"}, "right"),
        ({"onto": "left"}, "is on the panel that it lies on"),
        ({"at": (0.3, 0.0)}, "reaches beyond panel 'right'"),
        ({"at": (0.3,)}, "at must be two numbers"),
        ({"run": "left.9"}, "has no edge 9"),
    ],
)
def test_mistakes_are_told_in_a_line(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        meshed(patches=(patch(**given),))
    assert said in str(caught.value) and "\n" not in str(caught.value)
