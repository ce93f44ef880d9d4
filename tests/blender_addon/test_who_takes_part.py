"""Who takes part in a run, floors, and what is said of both, in real Blender."""

import json
from typing import Any

import numpy as np
import pytest

from tests.blender_addon.conftest import Blender
from toile.blender_addon.engine_side.wording import Wording


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("who_takes_part.py", tmp_path_factory.mktemp("who"))


def test_a_second_character_changes_nothing_of_the_first(found: dict[str, Any]) -> None:
    """Only selected, or with the body named: the first one's result is that of being alone, bit by bit."""
    assert found["selected"] == [["Bert", "Coat"]] and found["second dressed"] and found["first untouched"]
    assert found["first as alone"]


def test_characters_take_along_what_is_theirs_and_what_is_nobodys(found: dict[str, Any]) -> None:
    assert found["by character"] == [["Bert", "Floor", "Coat"], ["Anna", "Floor", "Hat", "Scarf"]]
    # A garment that names no body could touch any of them.
    assert found["one without a body"] == [["Anna", "Bert", "Floor", "Hat", "Coat", "Extra", "Scarf"]]
    assert found["together"] == [["Anna", "Bert", "Coat", "Scarf"]]


def test_an_empty_selection_is_said(found: dict[str, Any]) -> None:
    assert "no garment is selected" in found["no garment selected"]


@pytest.mark.parametrize("way", ["hide_viewport", "eye", "excluded"])
def test_what_the_view_layer_does_not_show_is_named_and_left_out(found: dict[str, Any], way: str) -> None:
    who, left_out = found["hidden"][way]
    assert who == [["Anna", "Bert", "Scarf"]]
    assert left_out == ["hidden or excluded in this view layer, and left out: 'Coat'"]


def test_a_hidden_body_is_named(found: dict[str, Any]) -> None:
    assert "'Anna', 'Bert'" in found["no body"] and "hidden" in found["no body"]
    assert found["shown again"] == [["Bert", "Coat"], ["Anna", "Scarf"]]


def test_a_body_in_an_instance_of_a_collection_is_dressed_where_it_is(found: dict[str, Any]) -> None:
    """The instance is 0.3 m higher than the body itself, whose top is at 1.25 m."""
    assert found["instance"] == [["Anna", "Scarf"]] and found["lowest on instance"] > 1.3


def test_cloth_stays_above_an_open_floor(found: dict[str, Any]) -> None:
    """On a plane that slopes, whichever way its faces look; it is said that it got a solid."""
    assert 0.0 < found["above floor"] < 0.01 and 0.0 < found["above turned floor"] < 0.01
    assert found["floor says"] == found["notes"] and found["floor says"][0].startswith("'Floor' is an open")


def test_a_floor_with_two_sides_is_an_error(found: dict[str, Any]) -> None:
    assert "'Floor' is an open surface" in found["both sides"] and "Solidify" in found["both sides"]


def test_the_engine_speaks_of_blenders_axes_and_objects(found: dict[str, Any]) -> None:
    assert "'Scarf' is 19.5 m away from the body (along y)" in found["away"]
    assert "'Scarf' is 28.8 m away from the body (along z)" in found["above"]


def test_what_was_repaired_is_reported(found: dict[str, Any]) -> None:
    (said,) = found["hole says"]
    place = [float(part) for part in said.partition("near (")[2].partition(")")[0].split(",")]
    assert said.startswith("'Anna': 1 hole of 6 to 6 edges filled")
    assert np.abs(np.subtract(place, found["hole"])).max() < 0.02


def test_linked_objects_refuse_roles_and_overrides_keep_them(found: dict[str, Any]) -> None:
    assert "linked from people.blend" in found["linked role"] and "library override" in found["linked role"]
    assert found["override set"] == "NONE" and found["override kept"] == [True, "NONE", 7]


def test_an_override_shows_frames_and_keeps_them(found: dict[str, Any]) -> None:
    assert found["override garment"] == [[["Inner", "Anna"]], "", ["toile", "Subdivision"], 1]
    assert found["override frames kept"] == ["GARMENT", "complete", 1]


JOB = {
    "turn": [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
    "avatars": ["Anna"],
    "garments": [
        {"stem": "Shirt_001", "name": "Shirt.001", "pieces": ["Linen"]},
        {"stem": "Shirt", "name": "Shirt", "pieces": ["Red", "", "Blue"]},
    ],
}


@pytest.mark.parametrize(
    ("said", "wanted"),
    [
        ("avatar: 2 holes, near (0.26, 1.18, -0.05) m.", "'Anna': 2 holes, near (0.26, 0.05, 1.18) m."),
        ("garment Shirt_001: piece 0, faces 1, 2 of its file", "'Shirt.001', faces 1, 2 of its mesh"),
        ("garment Shirt: piece 0, piece 2, faces 4", "'Shirt', material Red, Blue, faces 4"),
        ("it is away (along y); it is away (along z)", "it is away (along z); it is away (along y)"),
        ("/tmp/a/Shirt.npz: 5 faces have no area", "'Shirt': 5 faces have no area"),
        ("garment 'Shirt' and Shirt_001.npz", "'Shirt' and 'Shirt.001'"),
    ],
)  # fmt: skip
def test_sentences_are_translated(said: str, wanted: str) -> None:
    from pathlib import Path

    assert Wording(Path("/tmp/a"), json.loads(json.dumps(JOB)))(said) == wanted
