"""What is to be simulated is drafted where the simulation starts, in real Blender."""

from pathlib import Path

import pytest

from tests.blender_addon.conftest import Blender


def test_a_garment_is_drafted_where_its_simulation_starts(blender: Blender, tmp_path: Path) -> None:
    found = blender("one_place.py", tmp_path)
    assert found["SIMULATE"] == pytest.approx(2.0, abs=0.02)
    assert found["DRAPE"] == pytest.approx(5.0, abs=0.02)
    assert found["frame"] == 13
    # The second one was drafted for a drape in frame 13.
    assert "was drafted in frame 13, where the body is elsewhere than in frame 3" in found["error"]
    assert "let the simulation start there, or draft it again" in found["error"]
