"""The speed-error report: fronts, stored files, comparisons, pages, the command, and points of each scene."""

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from toile.dressing.cli.main import main
from toile.dressing.run.quality import QUALITIES
from toile.engine.film.integrators.backward_euler import backward_euler
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.geometry.errors import InputError
from toile.studies.adaptive import remesh
from toile.studies.scenes.flat_meshes import KINDS
from toile.studies.scenes.scenes import film_plan, hang
from toile.studies.scenes.swing import rms_distance
from toile.studies.speed_error import cantilever, shirt, swing
from toile.studies.speed_error.compare import compare_reports, comparison_text
from toile.studies.speed_error.films import (
    BASE,
    PRECONDITIONERS,
    FilmStudy,
    Way,
    also,
    distance,
    in_steps,
)
from toile.studies.speed_error.page_html import html_page
from toile.studies.speed_error.page_markdown import markdown_page, picture_name
from toile.studies.speed_error.pareto import pareto_front
from toile.studies.speed_error.plot import chart_svg
from toile.studies.speed_error.point import Bar, Chart, Effort, Point
from toile.studies.speed_error.stored import FORMAT, Report, read_report, write_report
from toile.studies.speed_error.studies import STUDIES
from toile.studies.speed_error.timed import repeated

QUIET = Effort(True, 1, lambda line: None)


def point(cpu: float, error: float, curve: str = "steps", label: str = "1/60 s", crossings: int = 0) -> Point:
    return Point(
        curve=curve, label=label, cpu=cpu, spread=0.1 * cpu, repeats=3, error=error, faces=100.0,
        crossings=crossings,
    )  # fmt: skip


def chart(*points: Point, floor: float = 0.0, bars: tuple[Bar, ...] = ()) -> Chart:
    return Chart(
        scene="swing", title="time <steps>", error="distance", unit="mm", reference="a fine one", floor=floor,
        points=points, bars=bars,
    )  # fmt: skip


def report(*charts: Chart, quick: bool = False, processor: str = "one") -> Report:
    return Report(quick=quick, machine={"processor": processor}, versions={"toile": "1"}, charts=charts)


def test_the_front_holds_what_nothing_beats() -> None:
    quick, exact, beaten = point(1.0, 10.0), point(4.0, 1.0), point(5.0, 2.0)
    crossing, broken, equal = point(0.5, 5.0, crossings=1), point(0.1, math.inf), point(1.0, 20.0)
    assert pareto_front([beaten, exact, crossing, equal, quick, broken]) == [quick, exact]
    assert pareto_front([crossing]) == []


def test_short_runs_are_repeated_and_long_ones_are_not() -> None:
    times = iter((1.0, 3.0, 2.0))
    result, timing = repeated(lambda: ("done", next(times)), 3)
    assert (result, timing.cpu, timing.spread, timing.repeats) == ("done", 2.0, 2.0, 3)
    assert repeated(lambda: (None, 100.0), 3)[1].repeats == 1


def test_growth_beyond_the_ratio_is_a_regression_in_time_error_and_crossings() -> None:
    old = report(chart(point(1.0, 10.0, label="a"), point(1.0, 10.0, label="b"), point(1.0, 10.0, label="c")))
    new = report(
        chart(
            point(1.3, 10.0, label="a"), point(1.2, 12.6, label="b"),
            point(0.5, 1.0, label="c", crossings=2), point(9.0, 9.0, label="new"),
        ),
        processor="another",
    )  # fmt: skip
    comparison = compare_reports(old, new, 1.25)
    assert [bool(one.regressed) for one in comparison.points] == [True, True, True]
    text = comparison_text(comparison, 1.25)
    for said in ("CPU time 1.30 x", "error 1.26 x", "crossings 0 to 2", "different machines", "1 points"):
        assert said in text
    assert not compare_reports(old, old, 1.0).regressions
    assert [one.place for one in compare_reports(old, new, 1.28).regressions] == [
        "swing, steps, a", "swing, steps, c",
    ]  # fmt: skip


def test_errors_below_the_floor_and_times_below_the_noise_do_not_count() -> None:
    old = report(chart(point(0.001, 0.1), floor=1.0))
    assert not compare_reports(old, report(chart(point(0.04, 0.9), floor=1.0)), 1.25).regressions
    assert compare_reports(old, report(chart(point(0.04, 1.5), floor=1.0)), 1.25).regressions
    assert compare_reports(old, report(chart(point(0.001, math.inf), floor=1.0)), 1.25).regressions


def test_only_reports_of_one_kind_with_something_in_common_are_compared() -> None:
    full = report(chart(point(1.0, 1.0)))
    with pytest.raises(InputError, match="quick"):
        compare_reports(full, replace(full, quick=True), 1.25)
    with pytest.raises(InputError, match="share no point"):
        compare_reports(full, report(), 1.25)


def test_a_stored_report_comes_back(tmp_path: Path) -> None:
    bars = (Bar(claim="time", value=2.0, limit=1.0),)
    whole = report(chart(point(1.0, math.inf), replace(point(2.0, 0.5), preset="standard"), bars=bars))
    write_report(tmp_path / "report.json", whole)
    assert read_report(tmp_path / "report.json") == whole
    assert "date" not in (tmp_path / "report.json").read_text()
    with pytest.raises(InputError, match="cannot be written"):
        write_report(tmp_path / "nowhere" / "report.json", whole)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"{", "cannot be read"),
        (b"\xff", "cannot be read"),
        (b"[]", "not a stored report"),
        (b'{"format": "another"}', "not a stored report"),
        (json.dumps({"format": FORMAT}).encode(), "report: quick is missing"),
        (
            json.dumps(
                {"format": FORMAT, "quick": False, "machine": {}, "versions": {}, "charts": [{"scene": 3}]}
            ).encode(),
            "report: charts 0: scene must be a text",
        ),
        (
            json.dumps({"format": FORMAT, "quick": 1, "machine": {}, "versions": {}, "charts": []}).encode(),
            "quick must be true or false",
        ),
        (
            json.dumps({"format": FORMAT, "quick": True, "machine": {"cores": []}}).encode(),
            "machine must be a table",
        ),
    ],
)
def test_a_bad_file_is_named_with_what_is_wrong(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "bad.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=said) as caught:
        read_report(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


class Balanced(HTMLParser):
    """Checks that every element that is opened is closed."""

    EMPTY = ("meta", "link", "br", "img")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def test_pages_are_well_formed_and_show_every_curve() -> None:
    fast = replace(point(1.0, 10.0, curve="a < b"), preset="preview")
    shown = chart(fast, point(3.0, 2.0, curve="c & d", crossings=4), point(2.0, math.inf), floor=0.5)
    whole = report(replace(shown, bars=(Bar(claim="error", value=10.0, limit=1.0),)))
    page = Balanced()
    page.feed(html_page(whole, "toile bench swing"))
    page.close()
    assert not page.open
    picture = ElementTree.fromstring(chart_svg(shown))
    said = " ".join(picture.itertext())
    for text in (page.text, said):
        assert all(word in text for word in ("time <steps>", "a < b", "c & d", "preview"))
    assert "broke down" in page.text and "missed" in page.text
    assert "4 crossings" in said
    markdown = markdown_page(whole, "toile bench swing")
    assert f"({picture_name(shown)})" in markdown and "**missed**" in markdown
    assert "| a < b | 1/60 s (preset) | 1 |" in markdown


def test_a_chart_without_points_is_drawn() -> None:
    empty, one = (
        ElementTree.fromstring(chart_svg(drawn)) for drawn in (chart(), chart(point(1.0, 1.0, "a curve")))
    )
    assert "a curve" not in "".join(empty.itertext()) and "a curve" in "".join(one.itertext())


def test_times_at_equal_error_are_read_between_points() -> None:
    slow = [point(1.0, 100.0, "slow"), point(100.0, 1.0, "slow")]
    fast = [point(1.0, 10.0, "fast"), point(4.0, 2.5, "fast")]
    assert swing.time_at(slow, 10.0) == pytest.approx(10.0)
    assert swing.time_at(slow, 0.5) is None
    assert swing.time_ratios([*slow, *fast], "slow", "fast") == pytest.approx([10.0, 10.0])
    nearer = point(4.0, 0.5, "fast")
    assert swing.time_ratios([*slow, nearer], "slow", "fast") == pytest.approx([25.0])
    assert swing.time_ratios([*slow, nearer], "fast", "slow") == []


def test_a_swinging_sheet_and_a_point_of_it() -> None:
    sheet = swing.triangles(10, 10_000)

    def error(x: np.ndarray) -> float:
        return rms_distance(x, sheet.end)

    go = swing.equal(*swing.METHODS["TR-BDF2"], 60)
    found = sheet.point(QUIET, "TR-BDF2", "1/60 s", go, error)
    assert found.faces == 200 and found.figures["steps"] == 60
    assert 1.0 < found.error < 100.0
    assert swing.springs(10).faces == 200


def test_a_finer_strip_is_nearer_to_the_elastica_and_springs_are_far_from_it() -> None:
    errors = [
        cantilever.strip_point(QUIET, "", "", strip, cantilever.SOLVED).error
        for strip in (*(cantilever.triangles(KINDS[0], count) for count in (10, 20)), cantilever.springs(10))
    ]
    assert errors[0] == pytest.approx(11.4, rel=0.1)
    assert errors[1] == pytest.approx(3.1, rel=0.1)
    assert errors[2] > 100.0


def test_films_differ_by_what_their_way_says() -> None:
    plan = film_plan()
    fine = in_steps(480, backward_euler)(plan)
    assert fine.integrator is backward_euler and fine.longest_step == pytest.approx(1.0 / 480.0)
    assert fine.motion_max == pytest.approx(0.25 * plan.motion_max)
    assert BASE(plan).integrator is tr_bdf2
    # One thing at a time.
    assert also(newton=2)(plan) == replace(BASE(plan), newton=2)
    assert also(cg_tolerance=0.1)(plan) == replace(BASE(plan), cg_tolerance=0.1)

    study = FilmStudy("hang", hang, 0.1, (0.4,))
    names = [(way.curve, way.label) for way in study.ways(Effort(False, 1, print))]
    assert len(names) == len(set(names))
    reference = study.run(Way("uniform meshes", "", 0.1), 0.2)
    solved = Way("preconditioner", "", 0.1, preconditioning=PRECONDITIONERS["Gauss-Seidel"])
    other = study.run(solved, 0.2)
    assert distance(reference, reference) == pytest.approx(0.0, abs=1e-9)
    assert 0.0 < distance(other, reference) < 20.0
    assert other.steps >= 24 and 0.0 < other.audit_share < 1.0


def test_presets_are_dressed_as_the_scene_would() -> None:
    ways = shirt.presets("presets", tuple(QUALITIES))
    assert [way.label for way in ways] == list(QUALITIES)
    assert [(way.edge, way.angle, way.tolerance, way.max_frames) for way in ways] == [
        (quality.edge_length, quality.refine_angle, quality.tolerance, quality.max_frames)
        for quality in QUALITIES.values()
    ]


def stub(effort: Effort) -> Iterator[Chart]:
    yield chart(point(1.0, 10.0), bars=(Bar(claim="error", value=10.0, limit=1.0),))
    raise KeyboardInterrupt


def test_the_command_stores_what_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(STUDIES, "swing", stub)
    out = tmp_path / "out"
    assert main(["bench", "swing", "--quick", "--out", str(out)]) == 130
    stored = read_report(out / "speed_error.json")
    assert stored.quick and len(stored.charts) == 1
    names = {path.name for path in out.iterdir()}
    assert {"speed_error.html", "speed_error.md", picture_name(stored.charts[0])} <= names
    capsys.readouterr()

    monkeypatch.setitem(STUDIES, "swing", lambda effort: iter((chart(point(1.0, 1.0)),)))
    assert main(["bench", "swing", "--json", str(tmp_path / "old.json")]) == 0
    missed = chart(point(2.0, 1.0), bars=(Bar(claim="error", value=10.0, limit=1.0),))
    monkeypatch.setitem(STUDIES, "swing", lambda effort: iter((missed,)))
    assert main(["bench", "swing", "--json", str(tmp_path / "new.json")]) == 1
    files = [str(tmp_path / "old.json"), str(tmp_path / "new.json")]
    assert main(["bench", "compare", *files]) == 1
    assert "CPU time 2.00 x" in capsys.readouterr().out
    assert main(["bench", "compare", *files, "--ratio", "3"]) == 0


@pytest.mark.parametrize(("crossings", "code"), [(0, 0), (1, 1)])
def test_the_study_of_adaptive_meshes_keeps_its_options_and_exit_code(
    crossings: int, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, float | None, int]] = []

    def bench(name: str, seconds: float | None, repeats: int, say: object) -> remesh.Row:
        asked.append((name, seconds, repeats))
        return remesh.Row(
            scene=name, cpu_ratio=10.0, face_ratio=0.1, error_ratio=3.0, remesh_share=0.01, energy_jump=0.0,
            energy_drop=0.0, crossings=crossings, repeats=repeats, cpu_adaptive=1.0, cpu_reference=9.0,
            cpu_spread=0.0, faces_adaptive=100.0, error_unit="mm", error_adaptive=1.0, distance_adaptive=1.0,
            turn_adaptive=2.0, turn_reference=2.0,
            uniform=(),
        )  # fmt: skip

    monkeypatch.setattr(remesh, "bench_scene", bench)
    stored = tmp_path / "rows.json"
    options = ["--scene", "hang", "--seconds", "0.5", "--repeats", "2", "--json", str(stored)]
    assert main(["bench", "remesh", *options]) == code
    assert asked == [("hang", 0.5, 2)]
    assert json.loads(stored.read_text())[0]["scene"] == "hang"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["swimg"], "did you mean 'swing'"),
        (["swing", "--repeats", "0"], "--repeats must be at least 1"),
        (["swing", "--seconds", "1"], "--seconds does not apply to toile bench swing"),
        (["remesh", "--quick"], "--quick does not apply to toile bench remesh"),
        (["remesh", "hang"], "remesh takes no names"),
        (["remesh", "--scene", "hangg"], "did you mean 'hang'"),
        (["compare", "one.json"], "compare takes two"),
        (["compare", "one.json", "two.json"], "one.json: there is no such report"),
        (["compare", "one.json", "two.json", "--ratio", "0.5"], "--ratio must be at least 1"),
        (["swing", "--json", "nowhere/report.json"], "nowhere/report.json: cannot be written"),
    ],
)
def test_a_slip_of_the_pen_is_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_pictures_of_all_scenes_have_names_of_their_own() -> None:
    titles = [("swing", "time steps, 50 x 50 cells"), ("swing", "meshes and models"), ("hang", "meshes")]
    names = {picture_name(replace(chart(), scene=scene, title=title)) for scene, title in titles}
    assert len(names) == len(titles)
