"""Gravity in any direction, what changes with the animation, and the same bytes again, in real Blender."""

from pathlib import Path
from typing import Any

import pytest

from tests.blender_addon.conftest import Blender


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("weather.py", tmp_path_factory.mktemp("weather"))


def test_cloth_hangs_where_gravity_points(found: dict[str, Any]) -> None:
    """Along X, along a diagonal and upwards, by as much as downwards."""
    depth, _ = found["upright"]
    assert depth < -0.1
    for local, farthest in found["turned"]:
        assert local == pytest.approx(depth, abs=0.01)
        assert farthest == pytest.approx(-0.26 - depth, abs=0.01)


def test_gravity_that_changes_is_said(found: dict[str, Any]) -> None:
    """It is as it is in the first frame, wherever the playhead is."""
    assert found["notes"] == [
        "Warning: gravity changes with the animation: it stays as it is in the first frame"
    ]
    assert found["gravity"] == "gravity = 9.810000"


def test_wind_that_changes_is_keyed(found: dict[str, Any]) -> None:
    """From 1 to 4 m/s upwards within three frames, eased in and out; the rest of the air is still."""
    still, fan, times, velocities = found["air"]
    assert (still, fan) == ("velocity = [0.000000, 0.000000, 0.000000]", "[[air.fan]]")
    assert times == "times = [0, 0.0416666667, 0.0833333333]"
    assert velocities.startswith("velocities = [[0.000000, 1.000000, 0.000000], [0.000000, 2.5")
    assert velocities.endswith("[0.000000, 4.000000, 0.000000]]")


def test_the_same_script_gives_the_same_bytes(
    found: dict[str, Any], blender: Blender, tmp_path: Path
) -> None:
    """In another process, where Blender orders the faces of its sphere in another way."""
    assert blender("weather.py", tmp_path)["hash"] == found["hash"]
