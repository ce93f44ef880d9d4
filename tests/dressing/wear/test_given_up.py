"""A garment that cannot be put on is given up after a bounded amount of work, with what, where and why."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import toile
from tests.dressing.conftest import FakeDrape
from tests.dressing.garment.mesh_parts import read, tube
from toile.dressing.run import hang
from toile.dressing.wear import put_on


def scene(garment: str = "tshirt") -> toile.Scene:
    return toile.Scene(garments=[toile.Garment(garment)], quality="preview", edge_length=0.05, remesh=False)


@pytest.mark.parametrize(
    ("most", "what", "where"),
    [
        (10, "66 stitches did not close, gap up to 196 mm", "left_sleeve_front.0 - front.2"),
        (50, "jammed while it was still growing", "the body lacks 31 mm near (0.01, 1.40, -0.04) m"),
    ],
)
def test_the_first_attempt_has_a_limit_of_work(
    most: int, what: str, where: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(put_on, "MOST_WORK", 0.0)
    monkeypatch.setattr(put_on, "MOST_PER_FACE", most)
    result = toile.dress(scene())
    assert result.status == "failed" and result.failure is not None
    assert f"given up after {most} Newton iterations per face" in result.failure.message
    assert result.report["newton_iterations"] == most
    assert what in result.failure.message and where in result.failure.where


def test_too_few_frames_are_the_reason_that_is_given() -> None:
    """And not the size of the garment."""
    result = toile.dress(replace(scene(), max_frames=3))
    assert result.failure is not None and result.failure.kind == "open_seams"
    assert (
        "the frame limit was reached while the garment was still sewing; allow more" in result.failure.message
    )
    assert "too small" not in result.failure.message


@pytest.mark.parametrize("garment", ["tshirt", "trousers", "circle_skirt"])
def test_garments_that_fit_stay_far_below_it(garment: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(put_on, "MOST_WORK", 0.0)
    monkeypatch.setattr(put_on, "MOST_PER_FACE", put_on.MOST_PER_FACE // 3)
    assert toile.dress(scene(garment)).status == "converged"


def test_attempts_in_the_same_triangles_are_made_once(
    fake_drape: Callable[..., FakeDrape], tmp_path: Path
) -> None:
    """A mesh of short edges is not sewn, and looks alike in all edge lengths: only the last may differ."""
    fake = fake_drape()
    fake.jams = 6
    read(tmp_path, tube())
    toile.dress(toile.Scene(garments=[toile.Garment(tmp_path / "dirty.obj")], edge_length=0.03))
    assert [options.persistent for _, _, options in fake.calls] == [False, True]


def test_the_last_attempt_gets_what_is_left_but_enough(tmp_path: Path) -> None:
    mesh = read(tmp_path, tube())
    assert hang._work_left([mesh], 900_000, 600_000) == 1_200_000, "twice what the one before took"
    assert hang._work_left([mesh], 2_000_000, 1_500_000) == 1_500_000, "three and a half million in all"
    many = [mesh] * (8000 // len(mesh.faces))
    faces = len(many) * len(mesh.faces)
    assert hang._work_left(many, 900_000, 800_000) == 300 * faces, "what jammed garments need once more"
    assert hang._work_left(many, 4_500_000, 2_500_000) == hang.LAST_WORK, "never more than a minute in all"
