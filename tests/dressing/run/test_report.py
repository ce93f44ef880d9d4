import json
from typing import Any

import pytest

from tests.dressing.report_keys import VOLATILE_KEYS
from toile.dressing.run.progress import ProgressPrinter, ProgressState, TimeLeft, progress_text
from toile.dressing.run.report import RunSpent, drape_report, report_bytes, with_animation
from toile.dressing.wear.drape_types import DrapeFigures, DrapeOptions, Failure, FrameState, StrainedPlace
from toile.geometry.stage_clock import Spent

FIGURES = DrapeFigures(
    frames=12,
    simulated_seconds=0.5,
    steps=30,
    newton_iterations=60,
    cg_iterations=900,
    nodes=(10, 11, 12),
    faces=(20, 21, 22),
    contacts_max=5,
    avatar_intersections=0,
    self_intersections=1,
    worst_frame_intersections=2,
    min_gap_mm=float("nan"),
    warp_strain_max=1.0,
    weft_strain_max=2.0,
    strain_p99=0.5,
    areas=((0.62, 0.58),),
    strained=(StrainedPlace(percent=61.0, faces=3, where="garment a: front"),),
    residual=float("inf"),
    remeshings=2,
    splits=30,
    flips=20,
    collapses=10,
    energy_jump_max=0.001,
    pop=0.0005,
    stages={"solve": Spent(1.0, 1.5), "io": Spent(0.25, 0.5)},
)


def make(**changes: Any) -> dict[str, Any]:
    values: dict[str, Any] = {
        "status": "failed",
        "failure": Failure(kind="tangled", message="no way", where="panel a"),
        "figures": FIGURES,
        "quality": "preview",
        "options": DrapeOptions(edge_length=0.02, max_frames=100, tolerance=0.01),
        "avatar": {"name": "box"},
        "garments": [{"name": "a"}],
        "spent": RunSpent(total=Spent(2.0, 3.0), io=Spent(0.5, 0.75), compile=Spent(0.125, 0.25)),
    }
    return drape_report(**{**values, **changes})


def test_every_promised_key_is_there() -> None:
    report = json.loads(report_bytes(make()))
    assert report["status"] == "failed"
    assert report["failure"] == {"class": "tangled", "message": "no way", "where": "panel a"}
    for key in ("frames", "simulated_seconds", "wall_seconds", "cpu_seconds", "steps", "residual"):
        assert key in report
    assert report["newton_iterations"] == 60
    assert report["cg_iterations"] == 900
    assert report["nodes"] == {"initial": 10, "final": 11, "max": 12}
    assert report["faces"] == {"initial": 20, "final": 21, "max": 22}
    assert report["intersections"] == {"avatar": 0, "self": 1, "worst_frame": 2}
    assert report["strain_percent"] == {
        "warp_max": 1.0, "weft_max": 2.0,
        "p99": 0.5, "over_50": [{"percent": 61.0, "faces": 3, "where": "garment a: front"}],
    }  # fmt: skip
    assert report["garments"] == [{"name": "a", "area_m2": 0.62, "cut_area_m2": 0.58}]
    assert report["stage_cpu_seconds"] == {
        "assembly": 0.0, "solve": 1.0, "contact": 0.0, "avatar": 0.0, "remesh": 0.0, "audit": 0.0, "io": 0.75,
        "compile": 0.125, "other": 0.125,
    }  # fmt: skip
    assert report["stage_wall_seconds"]["io"] == 1.25
    assert report["stage_wall_seconds"]["compile"] == 0.25
    assert report["contacts_max"] == 5
    assert report["remeshing"] == {
        "passes": 2, "splits": 30, "flips": 20, "collapses": 10, "energy_jump_max": 0.001, "pop_mm": 0.5,
    }  # fmt: skip


def test_json_has_no_infinities() -> None:
    report = make()
    assert report["min_gap_mm"] is None
    assert report["residual"] is None
    assert make(failure=None, status="converged")["failure"] is None


def test_stages_add_up_to_the_whole_run_before_and_after_a_film() -> None:
    drape = make()
    booked = {"contact": Spent(4.0, 6.0), "avatar": Spent(1.0, 1.5)}
    film = with_animation(drape, "converged", None, {}, {}, booked, Spent(6.0, 9.0))
    for report, total in ((drape, Spent(2.0, 3.0)), (film, Spent(8.0, 12.0))):
        assert (report["cpu_seconds"], report["wall_seconds"]) == total
        for clock in ("cpu", "wall"):
            assert sum(report[f"stage_{clock}_seconds"].values()) == pytest.approx(report[f"{clock}_seconds"])
    assert film["stage_cpu_seconds"]["contact"] == 4.0 and film["stage_wall_seconds"]["contact"] == 6.0
    # What the film did not book is added to what the drape did not.
    assert film["stage_cpu_seconds"]["other"] == pytest.approx(0.125 + 1.0)


def test_only_volatile_keys_differ_between_runs() -> None:
    first, second = (
        make(),
        make(spent=RunSpent(total=Spent(8.0, 9.0), io=Spent(1.0, 2.0), compile=Spent(1.0, 1.0))),
    )
    assert {key for key in first if first[key] != second[key]} <= set(VOLATILE_KEYS)


def frame(number: int, residual: float, limit: int = 1000) -> FrameState:
    return FrameState(
        frame=number, faces=9, contacts=8, residual=residual, seconds=2.0 * number, max_frames=limit
    )


def test_time_left_follows_the_decay_of_the_residual() -> None:
    clock = TimeLeft(tolerance=1e-4)
    for number in range(1, 9):
        left = clock.update(frame(number, 10.0 ** (-0.25 * number)))
    # The residual passes 1e-4 in frame 16, eight frames of two seconds from here.
    assert left == pytest.approx(16.0, rel=1e-6)


def test_time_left_is_bounded_by_the_frame_limit() -> None:
    clock = TimeLeft(tolerance=1e-4)
    for number in range(1, 9):
        left = clock.update(frame(number, 1.0 + number, limit=10))
    assert left == pytest.approx(4.0)
    assert TimeLeft(0.1).update(frame(0, 1.0)) is None


class Terminal:
    def __init__(self, tty: bool) -> None:
        self.text = ""
        self.tty = tty

    def write(self, text: str) -> None:
        self.text += text

    def flush(self) -> None:
        pass

    def isatty(self) -> bool:
        return self.tty


def state(number: int, seconds: float) -> ProgressState:
    return ProgressState(
        frame=number,
        max_frames=100,
        faces=12345,
        contacts=67,
        residual=0.0123,
        tolerance=0.01,
        seconds=seconds,
        seconds_left=83.0,
    )


def test_progress_line_says_what_matters() -> None:
    text = progress_text(state(5, 1.0))
    assert text == "frame 5/100  faces 12345  contacts 67  residual 0.012 (goal 0.01)  about 1:23 left"


def test_terminal_line_is_overwritten_and_plain_output_is_sparse() -> None:
    terminal, plain, quiet = Terminal(True), Terminal(False), Terminal(True)
    printers = [
        ProgressPrinter(terminal),  # type: ignore[arg-type]
        ProgressPrinter(plain),  # type: ignore[arg-type]
        ProgressPrinter(quiet, quiet=True),  # type: ignore[arg-type]
    ]
    for printer in printers:
        for number in range(12):
            printer(state(number, float(number)))
        printer.close()
    assert terminal.text.count("\r") == 12
    assert terminal.text.count("\n") == 1
    assert plain.text.count("\n") == 3
    assert "\r" not in plain.text
    assert quiet.text == ""
