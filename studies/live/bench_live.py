"""Scenes of a sheet that is played with: CPU time of a step, largest stretch, crossings."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass
from time import thread_time
from typing import Any

import numpy as np

from toile.dressing.live.sheet import Sheet, surface_of
from toile.dressing.run.air import Air
from toile.engine.live.live_cloth import LiveCloth
from toile.engine.step.options import StepOptions

WARMING, AUDITED = 100, 25
"""Steps before anything is measured; every so many are audited."""
MEDIAN, HIGH, STRETCH = 14.0, 25.0, 10.0
"""Bars: CPU time of a step, median and 95th percentile [ms]; largest stretch [%]."""


@dataclass(frozen=True, kw_only=True)
class LiveRow:
    """One scene.

    Attributes
    ----------
    scene
        Its name.
    nodes
        Nodes of the sheet.
    median, high
        CPU time of a step, median and 95th percentile [ms].
    stretch
        Largest stretch [%].
    crossings
        Crossing pairs in all audits.
    """

    scene: str
    nodes: int
    median: float
    high: float
    stretch: float
    crossings: int

    def missed(self) -> bool:
        """Whether a bar was missed."""
        fast = self.median <= MEDIAN and self.high <= HIGH
        return not (fast and self.stretch <= STRETCH and self.crossings == 0)


def _still(live: LiveCloth, step: int) -> None:
    """Leave the cloth alone."""


def _moving_ball(live: LiveCloth, step: int) -> None:
    """Move the ball about."""
    t = step / 60.0
    way = np.array([0.15 * np.sin(2.0 * t), 0.05 * np.sin(3.0 * t), 0.15 * np.cos(2.0 * t) - 0.15])
    live.move_obstacle("ball", surface_of("ball")[0] + way)


def _dragged(live: LiveCloth, step: int) -> None:
    """Pull a point about at up to 1.5 m/s."""
    if step == WARMING:
        live.grip(int(0.32 * len(live.frame.positions)))
    if live.hand.holds:
        t = (step - WARMING) / 60.0
        way = [0.4 * np.sin(2.5 * t), 0.15 + 0.2 * np.sin(1.7 * t), 0.4 * np.sin(3.3 * t)]
        live.pull_to(np.array(way))


SCENES: dict[str, tuple[dict[str, str], float, Callable[[LiveCloth, int], None]]] = {
    "hanging": ({"pins": "corners", "object": "none"}, 0.0, _still),
    "wind": ({"pins": "corners", "object": "none"}, 4.0, _still),
    "moving ball": ({"pins": "corners", "object": "ball"}, 0.0, _moving_ball),
    "falling on a ball": ({"pins": "none", "object": "ball"}, 0.0, _still),
    "hanging, dragged": ({"pins": "corners", "object": "none"}, 0.0, _dragged),
    "on a ball, dragged": ({"pins": "none", "object": "ball"}, 0.0, _dragged),
    "as the demo, 30 cells": ({"pins": "corners", "object": "ball"}, 0.0, _still),
    "as the demo, 50 cells": ({"pins": "corners", "object": "ball"}, 0.0, _still),
}
"""Pins and object of a sheet, wind [m/s], and what is done before every step."""
OWN_CELLS = {"as the demo, 30 cells": 30}
"""Cells of scenes that have a number of their own."""


def bench_live(names: Iterable[str] = SCENES, cells: int = 50, steps: int = 400) -> Iterator[LiveRow]:
    """Yield a row per scene of a sheet of `cells` x `cells`."""
    for name in names:
        kind, speed, play = SCENES[name]
        sheet = Sheet(cells=OWN_CELLS.get(name, cells), **kind)  # type: ignore[arg-type]
        air = Air(velocity=(0.9 * speed, 0.0, 0.43 * speed)).flow() if speed else None
        live = LiveCloth(sheet.cloth(), sheet.obstacles(), StepOptions(air=air))
        times, stretch, crossings = [], 0.0, 0
        for step in range(steps):
            play(live, step)
            started = thread_time()
            frame = live.advance()
            spent = thread_time() - started
            if step >= min(WARMING, steps // 2):
                times.append(1e3 * spent)
                stretch = max(stretch, 100.0 * frame.stretch)
            if step % AUDITED == AUDITED - 1:
                found = live.audit()
                crossings += len(found.avatar) + len(found.cloth)
        median, high = np.percentile(times, [50.0, 95.0])
        yield LiveRow(
            scene=name, nodes=len(live.frame.positions), median=float(median), high=float(high),
            stretch=stretch, crossings=crossings,
        )  # fmt: skip


def live_table(rows: list[LiveRow]) -> str:
    """Return rows as text."""
    lines = [f"{'scene':21s} nodes   median      p95  stretch  crossings"]
    for row in rows:
        bar = "  missed" if row.missed() else ""
        lines.append(
            f"{row.scene:21s} {row.nodes:5d} {row.median:6.1f} ms {row.high:6.1f} ms {row.stretch:6.1f} % "
            f"{row.crossings:9d}{bar}"
        )
    return "\n".join(lines)


def as_json(rows: list[LiveRow]) -> list[dict[str, Any]]:
    """Return rows as JSON."""
    return [asdict(row) | {"missed": row.missed()} for row in rows]
