"""Solids beside the body that cloth meets, in real Blender."""

from typing import Any

import pytest

from tests.blender_addon.conftest import Blender


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("obstacles.py", tmp_path_factory.mktemp("obstacles"))


def test_the_engine_reads_what_stands_and_what_moves(found: dict[str, Any]) -> None:
    """A file each, of metres and Y up, with the friction that an object has of its own."""
    assert found["files"] == ["obstacle 0.npz", "obstacle 1.ply"]
    assert found["toml"] == [
        "[[obstacle]]", 'file = "obstacle 0.npz"', 'name = "Comes"', 'units = "m"', 'up = "y"',
        "[[obstacle]]", 'file = "obstacle 1.ply"', 'name = "Table"', 'units = "m"', 'up = "y"',
        "friction = 0.125",
    ]  # fmt: skip
    assert not found["none"]


def test_cloth_meets_them(found: dict[str, Any]) -> None:
    """It lies on the table, whose top is at 0.85 m, and the ball, of a radius of 0.1 m, presses it in."""
    assert found["state"] == "complete"
    (lowest, away), (lowest_later, pressed) = found["frames"]
    assert 0.85 <= lowest < 0.86 and 0.85 <= lowest_later < 0.86
    assert away > 0.12 and 0.098 < pressed < 0.105
