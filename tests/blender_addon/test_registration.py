"""The add-on comes and goes without a trace, and quickly."""

from pathlib import Path

from tests.blender_addon.conftest import Blender

MAX_SECONDS = 0.5


def test_registers_and_unregisters_any_number_of_times(blender: Blender, tmp_path: Path) -> None:
    found = blender("registration.py", tmp_path)
    assert found["after"] == found["before"] and found["during"] != found["before"]
    assert found["during"]["properties"] == [True, True]
    assert found["loaded"] == []
    assert min(found["seconds"]) < MAX_SECONDS


def test_names_are_its_own(blender: Blender, tmp_path: Path) -> None:
    found = blender("registration.py", tmp_path)["during"]
    assert all(name.startswith("TOILE_") for name in found["types"]) and len(found["types"]) > 10
