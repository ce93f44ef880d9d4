"""How garments fit, as attributes and colours, in real Blender."""

from typing import Any

import pytest

from tests.blender_addon.conftest import Blender
from toile.dressing.fit.fit_maps import QUANTITIES

STRETCH = {"stretch_warp_percent", "stretch_weft_percent"}


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("fit.py", tmp_path_factory.mktemp("fit"))


def test_frames_carry_maps_if_asked_to(found: dict[str, Any]) -> None:
    """Stretch in all frames, everything in the last; the object's own of that name is not in the way."""
    assert found["state"] == "complete" and not found["without"]
    first, second, last = found["frames"]
    assert set(first) - {"pressure_Pa"} == set(second) - {"pressure_Pa"} == STRETCH
    assert set(last) == set(QUANTITIES) == set(found["maps"])
    most = max(found["strain"]["warp_max"], found["strain"]["weft_max"])
    for frame in found["frames"]:
        assert all(-30.0 < frame[name][0] < frame[name][1] < frame[name][2] for name in STRETCH)
    assert 0.0 < max(last[name][2] for name in STRETCH) <= most
    assert last["pressure_Pa"][2] < 5000.0
    pressed, free = found["pressed where it lies"]
    assert pressed > 5.0 and free < 0.05 * pressed


def test_one_click_shows_them_in_colours(found: dict[str, Any]) -> None:
    """And another brings the materials back; both outlast that the cloth is dressed again."""
    assert "has no such map in this frame" in found["refused"]
    stretch, pressure = found["shown"]
    assert stretch == [["toile fit stretch_warp_percent"], ["toile", "toile fit"]]
    assert pressure == [["toile fit pressure_Pa"], ["toile", "toile fit"]]
    assert found["stays"] == ["toile", "toile fit"]
    assert found["colours"] > 0.15
    assert found["back"] == [True, ["toile"]] and found["cleared"] == []


def test_nodes_read_cloth_and_maps(found: dict[str, Any]) -> None:
    assert found["asset"] == [1, True]
    same, off = found["read"]
    assert same and off == 0.0
