"""The benchmark of live cloth: bars, and that a hand drags."""

from dataclasses import replace

import pytest

from toile.dressing.cli.main import main
from toile.studies.live.bench_live import LiveRow, bench_live, live_table
from toile.studies.live.bench_page import bench_page
from toile.studies.live.page_row import PageRow, page_table


def test_a_row_misses_each_of_its_bars() -> None:
    good = LiveRow(scene="hanging", nodes=9, median=3.0, high=5.0, stretch=1.0, crossings=0)
    assert not good.missed()
    for worse in ({"median": 15.0}, {"high": 26.0}, {"stretch": 11.0}, {"crossings": 1}):
        assert replace(good, **worse).missed()
    assert "missed" in live_table([replace(good, crossings=1)])


def test_a_dragged_sheet_crosses_nothing_and_does_not_tear() -> None:
    (row,) = bench_live(["on a ball, dragged"], cells=12, steps=150)
    assert row.nodes == 169 and row.crossings == 0
    assert 0.0 < row.stretch < 12.0


def test_a_figure_of_the_page_misses_its_bar_also_where_there_is_none() -> None:
    row = PageRow(name="latency", value=99.0, unit="ms", bar=100.0)
    assert not row.missed()
    assert replace(row, value=101.0).missed() and replace(row, value=float("nan")).missed()
    assert "missed" in page_table([replace(row, value=101.0)])


def test_frames_are_streamed_to_another_process_at_the_rate_of_steps() -> None:
    pytest.importorskip("websockets", reason="websockets is not installed")
    (row,) = bench_page(["streaming"], seconds=1.0)
    assert 30.0 < float(row.note.split()[0]) <= 63.0
    assert 0.0 < row.value < 50.0


def test_bench_live_names_what_it_does_not_know(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "live", "latent"]) == 2
    assert "latency" in capsys.readouterr().err
