"""The benchmark of live cloth: bars, and that a hand drags."""

from dataclasses import replace

from toile.studies.live.bench_live import LiveRow, bench_live, live_table


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
