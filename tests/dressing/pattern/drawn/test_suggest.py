"""Seams suggested for drawn patterns: the true ones of five designs, which are sure, and what is asked."""

from pathlib import Path

import numpy as np
import pytest

from toile.dressing.pattern.drawn.dxf import read_dxf_pattern
from toile.dressing.pattern.drawn.freesewing_svg import read_freesewing_svg
from toile.dressing.pattern.drawn.piece import DrawnPattern, Notch, Piece
from toile.dressing.pattern.drawn.suggest import suggest_seams

SAMPLES = Path(__file__).parent / "samples"
TRUE = {
    "teagan": [
        "front.1 = back~.1",
        "front.3 = back~.3",
        "sleeve.1 = sleeve.3",
        "sleeve.2 = front~.2 + back.2",
    ],
    "aaron": ["front.2 = back~.2", "front.4 = back~.4"],
    "brian": [
        "back.2 = front~.2",
        "back.4 = front~.4",
        "sleeve.0 = sleeve.2",
        "sleeve.3 = front~.3 + back.3",
    ],
    "titan": ["back.0 = front.2", "back.2 = front.0", "back.4 = back~.4", "front.3 = front~.3"],
    "penelope": ["back.4 = front~.2"],
}
"""Seams of two sides that each design has, by hand, darts and waistband left out: fifteen."""


@pytest.mark.parametrize("design", TRUE)
def test_the_true_seams_are_among_few_candidates_and_sure(design: str) -> None:
    found = suggest_seams(read_freesewing_svg(SAMPLES / f"freesewing_{design}_34.svg"))
    names = [candidate.seam.name for candidate in found.candidates]
    assert set(TRUE[design]) <= set(names)
    assert len(names) <= 12
    assert set(TRUE[design]) <= {seam.name for seam in found.sure}


def test_fifteen_seams_are_counted() -> None:
    assert sum(map(len, TRUE.values())) == 15


def test_openings_are_never_sewn_silently() -> None:
    """Aaron has no sleeves: its armholes are of one length and stay open; its bindings may go either way."""
    found = suggest_seams(read_freesewing_svg(SAMPLES / "freesewing_aaron_34.svg"))
    sure = {seam.name for seam in found.sure}
    assert sure == set(TRUE["aaron"])
    assert any(question.startswith("front.3 = back~.3") for question in found.questions)


def test_darts_are_sewn_leg_to_leg_and_a_waistband_runs_past_them() -> None:
    found = suggest_seams(read_freesewing_svg(SAMPLES / "freesewing_penelope_34.svg"))
    sure = {seam.name for seam in found.sure}
    assert {"back.6 = back.7", "back.9 = back.10", "front.4 = front.5", "front.7 = front.8"} <= sure
    band = "front.9 + front.6 + front.3 + back~.5 + back~.8 + back~.11"
    assert [q.split("   ")[0] for q in found.questions] == [f"waistband.0 = {band}", f"waistband.2 = {band}"]


def test_twins_that_are_drawn_out_are_not_sewn_to_each_other() -> None:
    found = suggest_seams(read_dxf_pattern(SAMPLES / "synthetic_clo_english_teagan.dxf", allowance=0.0))
    assert not any({name for name, _ in c.edges} == {"36", "37"} for c in found.candidates)
    assert {"36.1 = 36.3", "37.1 = 37.3"} <= {seam.name for seam in found.sure}


def test_a_cap_whose_notches_do_not_tell_front_from_back_is_asked_for() -> None:
    found = suggest_seams(
        read_dxf_pattern(SAMPLES / "synthetic_accumark_astm_teagan.dxf", size="34", allowance=0.0)
    )
    assert [q.split("   ")[0] for q in found.questions] == ["TEAGAN-SL.2 = TEAGAN-FR~.2 + TEAGAN-BA.2"]


def test_halves_that_no_file_calls_halves_are_asked_for() -> None:
    drawn = read_dxf_pattern(SAMPLES / "own_tee_valentina_aama_r12.dxf", units="mm")
    questions = suggest_seams(drawn).questions
    assert any("FRONT" in question and "say fold = 5" in question for question in questions)


def polygon(
    name: str, *points: tuple[float, float], fold: int | None = None, notches: tuple[Notch, ...] = ()
) -> Piece:
    corners = np.array(points)
    edges = tuple(np.array([corners[n], corners[(n + 1) % len(corners)]]) for n in range(len(corners)))
    return Piece(name=name, edges=edges, fold=fold, notches=notches, words=name)


def test_nothing_is_sewn_from_fold_to_fold() -> None:
    """Hems of halves are as long as each other, and no seam."""
    corners = ((0.0, 0.0), (0.3, 0.0), (0.25, 0.6), (0.0, 0.6))
    found = suggest_seams(
        DrawnPattern(name="p", pieces=tuple(polygon(name, *corners, fold=3) for name in ("front", "back")))
    )
    assert [c.seam.name for c in found.candidates] == ["front.1 = back~.1"]


def test_two_edges_that_fit_one_are_both_asked_for() -> None:
    left = polygon("front", (0.0, 0.0), (0.4, 0.0), (0.4, 0.5), (0.0, 0.31))
    right = polygon("back", (0.0, 0.0), (0.27, 0.0), (0.23, 0.5), (0.0, 0.7))
    found = suggest_seams(DrawnPattern(name="p", pieces=(left, right)))
    assert not found.sure
