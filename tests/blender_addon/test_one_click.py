"""Dress This Body, and a pattern file, in real Blender."""

from pathlib import Path
from typing import Any

import pytest

from tests.blender_addon.conftest import Blender
from toile.dressing.cli.main import main


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder: Path = tmp_path_factory.mktemp("one_click")
    assert main(["patterns", "--write", str(folder)]) == 0
    return blender("one_click.py", folder, folder / "circle_skirt_specification.json")


def test_one_click_dresses_a_body(found: dict[str, Any]) -> None:
    assert found["answer"] == ["FINISHED"] and found["role"] == "AVATAR" and found["name"] == "tshirt"
    assert found["state"] == "complete"
    assert found["report"]["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    assert found["uv"] == ["UVMap"] and found["loose"] > 50 and "held_left_collar" in found["groups"]


def test_an_unsaved_file_is_told_before_any_work(found: dict[str, Any]) -> None:
    message, role, objects = found["unsaved"]
    assert "save the .blend file first" in message and role == "NONE" and objects == 1


def test_a_second_press_dresses_the_same_garment_again(found: dict[str, Any]) -> None:
    """It is drafted anew only where the quality is another, into the same object with its settings."""
    assert found["again"] == [["tshirt"], ["dress"]] and found["shown again"] == 1
    assert found["other quality"] == [["tshirt"], ["draft", "dress"]]
    assert found["kept"] == ["denim-12oz", ["Jersey"], True, "toile", True]


def test_garment_hangs_on_the_shoulders_of_a_body_that_stands_upright(found: dict[str, Any]) -> None:
    """In Blender's axes: Z up."""
    assert 0.7 < found["low"][2] < 1.1 and 1.35 < found["high"][2] < 1.6
    assert found["low"][0] == pytest.approx(-found["high"][0], abs=0.03)


def test_pattern_file_comes_in_as_outermost_garment(found: dict[str, Any]) -> None:
    imported = found["imported"]
    assert imported["role"] == "GARMENT" and imported["layer"] == 1 and imported["name"] == "circle_skirt"
    assert imported["panels"] >= 3 and imported["loose"] > 50
