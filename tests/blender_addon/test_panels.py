"""Panels, Esc and timers without a window, and how long operators take, in real Blender."""

from typing import Any

import pytest

from tests.blender_addon.conftest import Blender


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("panels.py", tmp_path_factory.mktemp("panels"))


def test_panels_draw_what_there_is(found: dict[str, Any]) -> None:
    """Every property and operator that they name exists, in every state of an object."""
    drawn = found["drawn"]
    assert drawn["plain"].count("toile.set_role") == 3 and "fabric" not in drawn["plain"]
    garment = drawn["garment"]
    for name in ("fabric", "pin_stiffness", "areal_density", "quantity", "use_fit", "toile.show_fit", "body"):
        assert name in garment
    assert "Frames: complete" in garment and "frame_start" not in garment
    assert "frame_start" in drawn["avatar"] and "fabric" not in drawn["avatar"]
    assert "use_friction" in drawn["obstacle"] and "friction" in drawn["obstacle"]


def test_a_run_in_a_window_comes_to_its_end(found: dict[str, Any]) -> None:
    """Ticks work, everything else passes through; the panel shows the run, and nothing stays behind."""
    answers, said, timers, over, texts, running = found["to the end"]
    going = "RUNNING_MODAL"
    assert answers == [going, going, "PASS_THROUGH", going, going, "FINISHED"]
    assert (said, timers, over) == ([], 0, True)
    assert "step 0" in texts[0] and "(Esc: stop" in texts[0] and texts[-1] is None
    assert "0.00 starting" in running and "toile.cancel" in running


def test_esc_stops_it(found: dict[str, Any]) -> None:
    answers, said, timers, over, texts, _ = found["esc"]
    assert answers[-1] == "FINISHED" and said == ["stopped at 1"]
    assert (timers, over, texts[-1]) == (0, True, None)


def test_operators_take_less_than_a_tenth_of_a_second(found: dict[str, Any]) -> None:
    """Those that do not run the engine, on a cloth of 3,721 vertices; others: `test_other_ways`."""
    assert len(found["took"]) == 6 and max(found["took"].values()) < 100.0, found["took"]
