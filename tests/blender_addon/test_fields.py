"""Values of the fabric that vertex groups, nodes and keyframes set, in real Blender."""

from typing import Any

import pytest

from tests.blender_addon.conftest import Blender


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("fields.py", tmp_path_factory.mktemp("fields"))


def test_vertex_groups_and_attributes_of_nodes_paint(found: dict[str, Any]) -> None:
    """Bending is in micronewton metres in the panel, in newton metres in the engine."""
    assert found["heavy"] == [1.0, 0.0] and found["made"] == [0.25, 0.25]
    weight, bending, _ = found["toml"]
    assert weight == 'areal_density = { attribute = "0", low = 0.100000001, high = 1 }'
    assert bending == 'bending_warp = { attribute = "1", low = 1e-06, high = 5e-06 }'


def test_keyframes_become_keys(found: dict[str, Any]) -> None:
    """Three frames at 24 per second."""
    assert found["toml"][2] == "pressure = { times = [0, 0.0416666667, 0.0833333333], values = [0, 4, 8] }"


def test_the_heavy_side_sags_more(found: dict[str, Any]) -> None:
    heavy, light = found["sag"]
    assert heavy < 1.5 * light < 0.0


def test_an_unknown_source_is_named(found: dict[str, Any]) -> None:
    assert "'Cloth' has no vertex group" in found["unknown"] and "'nowhere'" in found["unknown"]
