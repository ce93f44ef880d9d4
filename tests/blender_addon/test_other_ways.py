"""Messages, cancelling, and the mode that keeps the topology, in real Blender."""

from typing import Any

import pytest

from tests.blender_addon.conftest import Blender


@pytest.fixture(scope="module")
def found(blender: Blender, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return blender("other_ways.py", tmp_path_factory.mktemp("ways"))


@pytest.mark.parametrize(
    ("case", "message"),
    [
        ("unsaved", "save the .blend file first"),
        ("no avatar", "mark the body as avatar"),
        ("no garment", "mark one in its Physics properties"),
        ("one-sided", "no consistent right side (a Moebius strip)"),
        ("inside", "pairs of triangles still cross"),
    ],
)
def test_mistakes_are_named_in_one_line(found: dict[str, Any], case: str, message: str) -> None:
    assert message in found[case] and "\n" not in found[case] and "Traceback" not in found[case]


def test_what_was_mended_is_said(found: dict[str, Any]) -> None:
    assert found["degenerate"] == ["", "'My Shawl': 5 faces (1, 8, 9, 10, 17) are mended: no area"]


def test_faces_at_fault_are_selected(found: dict[str, Any]) -> None:
    """Faces of the object: a strip of twelve quads, each two triangles for the engine."""
    selected = found["selected"]
    assert 0 < len(selected) <= 12 and set(selected) <= set(range(12))
    assert "'My Shawl': " in found["one-sided"]
    assert 0 < found["inside selected"] < 36 and found["inside state"] == "failed"


def test_kept_topology(found: dict[str, Any]) -> None:
    """The sheet's own 81 vertices move, and modifiers below refine them."""
    kept = found["kept"]
    assert kept["modifiers"] == ["MESH_CACHE", "SUBSURF"] and kept["vertices"] == [289] * 3
    assert kept["moved"][0] == 0.0 and 0.005 < kept["moved"][1] < kept["moved"][2] < 0.2


def test_cancelled_midway(found: dict[str, Any]) -> None:
    cancelled = found["cancelled"]
    assert 3 <= cancelled["files"] < 20 and cancelled["sidecar"] == "cancelled"
    # A frame may be on disk and not be told yet.
    states = [f"cancelled after {cancelled['files'] - late} frames" for late in (0, 1)]
    assert cancelled["state"] in states
    assert cancelled["type"] == "MESH_SEQUENCE_CACHE" and cancelled["shown"] > 200


def test_blender_is_never_blocked_for_long(found: dict[str, Any]) -> None:
    """A tenth of a second is the aim; a busy machine is granted more."""
    assert found["cancelled"]["longest tick"] < 0.2


def test_frames_are_shown_within_a_second(found: dict[str, Any]) -> None:
    """After the time stamp of the file, with what it shows later as well."""
    assert len(found["waited"]) >= 2 and max(found["waited"]) < 1.0, found["waited"]
    at_once, later = found["seen"]
    assert at_once == later and len(set(at_once)) > 1


def test_cleared(found: dict[str, Any]) -> None:
    assert found["cleared"] == [[], False, 0]


def test_units_and_axes_are_blenders(found: dict[str, Any]) -> None:
    """A sheet 0.3 units wide, 1 unit above the floor, in a scene whose unit is a centimetre."""
    low, high = found["centimetres"]
    assert low == pytest.approx([0.0005, 0.01, -0.0015]) and high == pytest.approx([0.0035, 0.01, 0.0015])


def test_undo_and_redo(found: dict[str, Any]) -> None:
    assert found["undo"] == [[], ["MESH_CACHE"]]
