"""Every type of attribute in every domain, under any name, follows onto the shown mesh, in real Blender."""

from typing import Any

import numpy as np
import pytest

from tests.blender_addon.conftest import Blender
from toile.blender_addon.snapshot.mesh_arrays import corners


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("attributes.py", tmp_path_factory.mktemp("attributes"))


def test_every_type_domain_and_name_follows(found: dict[str, Any]) -> None:
    """9 types in 3 domains with 5 names each, and 6 names that mean something to USD; nothing is added."""
    assert found["count"] == 141 and found["faces"] not in (64, 128)
    assert found["wrong"] == [] and found["smooth"]


def test_what_cannot_follow_is_named(found: dict[str, Any]) -> None:
    assert "attribute 'pair' does not follow" in found["notes"]


def test_vertex_groups_follow_whatever_they_are_called(found: dict[str, Any]) -> None:
    assert found["weights off"] < 1e-6 and found["weights"] == 3


def test_active_and_rendering_maps_and_colours_stay_so(found: dict[str, Any]) -> None:
    """Whichever UV maps are active and render, and whatever they are called."""
    assert len(found["flags"]) == 5
    for own, shown, off in found["flags"]:
        assert shown == own and off < 1e-6


def test_the_nodes_go_with_the_frames(found: dict[str, Any]) -> None:
    assert found["modifiers"] == ["toile", "toile attributes"] and found["cleared"] == [0, 0]


def test_rounding_splits_no_corner() -> None:
    """Maps of two triangles whose common corners differ by a last digit, and by a millimetre."""
    loops = np.array([0, 1, 2, 0, 2, 3], np.int32)
    places = [[0.2, 0.0], [0.4, 0.0], [0.4, 0.2], [0.2, 1e-8], [0.40000004, 0.2], [0.2, 0.2]]
    uv = np.array(places, np.float32)
    corner, first = corners(loops, [uv])
    assert len(first) == 4 and corner[0] == corner[3] and corner[2] == corner[4]
    uv[3, 0] += 1e-3
    assert len(corners(loops, [uv])[1]) == 5
