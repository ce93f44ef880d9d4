"""No object shows another's frames or loses its own, in real Blender; a stub draws the frames."""

from typing import Any

import pytest

from tests.blender_addon.conftest import Blender


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return how many faces objects show: as many as runs had been made when their frames were."""
    return blender("ownership.py", tmp_path_factory.mktemp("ownership"))


def test_copies_get_frames_of_their_own(found: dict[str, Any]) -> None:
    """Duplicates, linked ones, and copies of the whole scene show what they were copied from until then."""
    assert found["copies show"] == [1, 1, 1] and found["each shows its own"] == [1, 2, 3]
    assert found["dressed again"] == [5, 2, 3]
    assert found["scene copied"] == [True, 1, True]


def test_clearing_touches_own_frames_only(found: dict[str, Any]) -> None:
    """The own mesh has 9 faces."""
    assert found["one cleared"] == [5, 9, 3] and found["the other cleared"] == [9, True]


def test_a_new_object_of_the_same_name_shows_its_own_frames(found: dict[str, Any]) -> None:
    """A path is not used again while Blender holds the USD layer that was there."""
    assert found["same name"] == [9, True]
    assert found["cache files"][0] == found["cache files"][1]


def test_names_that_differ_in_punctuation(found: dict[str, Any]) -> None:
    assert found["punctuation"] == [11, 12] and found["punctuation cleared"] == 12


def test_renamed_objects_keep_their_frames_and_take_them_along(found: dict[str, Any]) -> None:
    """What the run before the last left goes."""
    assert found["renamed"] and found["renamed goes"] == [False, "Coat"]


def test_files_saved_under_another_name_share_frames_until_one_is_gone(found: dict[str, Any]) -> None:
    assert found["another file shows them"] == [True, 9] and found["first file"]
    assert not found["no other file shows them"]


def test_a_file_that_was_renamed_owns_its_frames(found: dict[str, Any]) -> None:
    assert found["file renamed"] and not found["file renamed cleared"]


def test_frames_of_removed_objects_go_in_a_later_session(found: dict[str, Any]) -> None:
    assert found["orphan stays for undo"] and found["orphan goes"] == [False, True]
    assert found["missing"] == "missing on disk: dress it again"


def test_undo_leads_back_to_the_frames_of_the_run_before(found: dict[str, Any]) -> None:
    assert found["undo"]


def test_appended_objects_get_frames_of_their_own(found: dict[str, Any]) -> None:
    assert found["appended"] == [True, True] and found["appended dressed"] == 1
    assert found["appended cleared"] == [True, True]
