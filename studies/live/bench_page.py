"""What the page of live cloth costs: from pointer to pixel, to stream, and whether memory stays flat."""

import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.live.server import LiveServer
from toile.dressing.live.sheet import Sheet
from toile.dressing.live.wishes import Game
from toile.dressing.run.kernels import module_path_environment
from toile.geometry.errors import InputError
from toile.studies.live.page_row import PageRow

LATENCY, STREAMING, GROWTH = 100.0, 10.0, 5.0
"""Bars: from pointer to pixel, median [ms]; of one core [%]; of memory from a tenth of the time on [%]."""
PULLS, CELLS = 20, 50
STREAMED, WATCHED = 10.0, 600.0
"""Time that is streamed, and that memory is watched, unless told [s]."""
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
CLIENT = "from toile.studies.live.frame_taker import main; main()"

WATCH = """node => {
  const game = window.game;
  if (game.timed) return;
  game.timed = { times: [], from: null };
  const place = () => [...game.cloth.positions.slice(3 * node, 3 * node + 3)];
  game.stage.canvas.addEventListener("pointermove", () => {
    const t = game.timed;
    if (!t.armed) return;
    Object.assign(t, { armed: false, from: performance.now(), at: place() });
  }, true);
  const drawn = game.stage.drawNow.bind(game.stage);
  game.stage.drawNow = () => {
    drawn();
    const t = game.timed;
    if (t.from === null) return;
    if (Math.hypot(...place().map((value, k) => value - t.at[k])) < 2e-4) return;
    t.times.push(performance.now() - t.from);
    t.from = null;
  };
}"""
"""Notes when the pointer moves and when a picture is drawn in which the cloth under it has followed."""


@contextmanager
def _served(game: Any) -> Iterator[LiveServer[Any]]:
    """Serve a game while it is measured."""
    server = LiveServer(game)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.stop()
        thread.join(20.0)


def latency(seconds: float | None = None) -> PageRow:
    """Pull a point of hanging cloth by the pointer and wait until a picture shows that it has followed.

    Raises InputError where there is no browser.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        raise InputError("latency needs playwright: pip install 'toile[browser]'") from None
    browser = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if browser is None:
        raise InputError(f"latency needs a browser: {', '.join(BROWSERS)}")
    sheet = Sheet(cells=CELLS, object="none")
    node = (CELLS + 1) * (CELLS // 2) + CELLS // 2
    with _served(Game(sheet)) as server, sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=browser, args=FLAGS)
        page = chromium.new_page(viewport={"width": 1280, "height": 800})
        page.goto(server.url)
        page.wait_for_selector("[data-ready=yes]")
        time.sleep(6.0)
        page.evaluate(WATCH, node)
        for pull in range(PULLS):
            place = page.evaluate(
                "node => { const g = window.game, b = g.stage.canvas.getBoundingClientRect();"
                "const p = g.stage.project([...g.cloth.positions.slice(3 * node, 3 * node + 3)]);"
                "return [p[0] + b.left, p[1] + b.top]; }",
                node,
            )
            page.mouse.move(*place)
            page.mouse.down()
            # What is gripped comes to rest.
            time.sleep(0.7)
            page.evaluate("window.game.timed.armed = true")
            page.mouse.move(place[0] + (60 if pull % 2 else -60), place[1] - 30)
            page.wait_for_function(f"window.game.timed.times.length > {pull}", timeout=5000)
            page.mouse.up()
            time.sleep(0.7)
        times = page.evaluate("window.game.timed.times")
        rate = server.steps_per_second
        chromium.close()
    note = f"95th percentile {np.percentile(times, 95):.0f} ms, {len(times)} pulls at {rate:.0f} steps/s"
    return PageRow(name="latency", value=float(np.median(times)), unit="ms", bar=LATENCY, note=note)


class StillFrames:
    """Frames of cloth that costs nothing: what is left is what streaming costs."""

    def __init__(self) -> None:
        self.running, self.single, self.steps = True, 0, 0
        self._positions = np.random.default_rng(0).normal(size=(CELLS + 1) ** 2 * 3)

    def advance(self) -> None:
        """Count."""
        self.steps += 1

    def frame(self) -> bytes:
        """Return as many bytes as a frame of cloth has."""
        return b"\0" * 12 + self._positions.astype("<f4").tobytes()

    def scene(self) -> dict[str, Any]:
        """Return nothing."""
        return {}

    def state(self) -> dict[str, Any]:
        """Return nothing."""
        return {}

    def page(self, language: str) -> str:
        """Return no page."""
        return ""

    def carry_out(self, wish: Any) -> bool:
        """Do nothing."""
        return False

    def save(self, folder: Path) -> list[Path]:
        """Write nothing."""
        return []

    def close(self) -> None:
        """Nothing belongs to it."""


@contextmanager
def _taken(server: LiveServer[Any]) -> Iterator["subprocess.Popen[bytes]"]:
    """Have a process of its own take frames as fast as they come."""
    taker = subprocess.Popen(
        [sys.executable, "-P", "-c", CLIENT, server.url], env=module_path_environment(),
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    )  # fmt: skip
    end = time.monotonic() + 30.0
    while not server.pages and time.monotonic() < end:
        time.sleep(0.05)
    try:
        yield taker
    finally:
        taker.terminate()
        taker.wait(10.0)


def streaming(seconds: float | None = None) -> PageRow:
    """Stream frames of 2,601 nodes at 60 per second to another process; CPU time of this one."""
    span = seconds or STREAMED
    game = StillFrames()
    with _served(game) as server, _taken(server):
        time.sleep(1.0)
        steps, cpu, wall = game.steps, time.process_time(), time.perf_counter()
        time.sleep(span)
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        rate = (game.steps - steps) / wall
    share = 100.0 * cpu / wall
    return PageRow(name="streaming", value=share, unit="%", bar=STREAMING, note=f"{rate:.1f} frames/s")


def memory(seconds: float | None = None) -> PageRow:
    """Play with cloth that is dragged in wind over a moving ball, and watch the memory of this process."""
    span = seconds or WATCHED
    game = Game(Sheet(cells=CELLS))
    resident: list[float] = []
    with _served(game) as server, _taken(server):
        page = server.pages[0]
        server.wishes += [(page, {"do": "wind", "speed": 3.0}), (page, {"do": "ball_moves", "on": True})]
        end = time.monotonic() + span
        k = 0
        while time.monotonic() < end:
            node = 700 + 100 * (k % 8)
            wishes = (
                {"do": "grip", "node": node},
                {"do": "pull", "offset": [0.1, 0.15, 0.1]},
                {"do": "release"},
            )
            server.wishes.append((page, wishes[k % 3]))
            k += 1
            time.sleep(min(1.0, span / 20.0))
            resident.append(_resident())
        steps, journal = game.live.frame.step, len(game.journal)
    first, last = resident[len(resident) // 10], float(np.mean(resident[-max(1, len(resident) // 20) :]))
    note = f"{first:.0f} MB, at the end {last:.0f} MB; {span:.0f} s, {steps} steps, {journal} wishes"
    return PageRow(name="memory", value=100.0 * (last / first - 1.0), unit="%", bar=GROWTH, note=note)


def _resident() -> float:
    """Return the resident memory of this process [MB]."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    except OSError:
        raise InputError("memory is measured on Linux only") from None
    return pages * 4096 / 1e6


PAGE_STUDIES: dict[str, Callable[[float | None], PageRow]] = {
    "latency": latency, "streaming": streaming, "memory": memory,
}  # fmt: skip
"""What is measured of the page; each takes a time [s], or its own."""


def bench_page(names: Iterable[str], seconds: float | None = None) -> Iterator[PageRow]:
    """Yield a row per study."""
    for name in names:
        yield PAGE_STUDIES[name](seconds)
