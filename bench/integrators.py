"""Integrators and cloth models side by side: order, damping, stability, and error against CPU time.

python bench/integrators.py [--quick] [--json FILE] [--out bench/results] [--picture
docs/images/integrators.png]

1. Analytic systems: measured order on a spring pendulum, energy lost per second by a swing of 1 Hz in steps
of 1/60 s. 2. 961 particles (31 x 31) pinned along one edge swing for 1 s: mass-spring cloth and triangle
cloth under every
   integrator. Largest stable step, energy lost, error, CPU time.
3. `swing`, 50 x 50 cells (quick: 20 x 20), triangle cloth: error against CPU time over step sizes.
4. One Newton step at 10,201 nodes of woven cotton.

Errors are root mean square distances at t = 1 s to the same model in symplectic Euler steps so short that
they no longer matter: halving them moves the sheet by the stated floor, below which figures say nothing.
"""

import argparse
import json
import platform
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from statistics import median

import numpy as np
from integrators_page import draw, page

from toile.dressing.garment.fabrics import fabric
from toile.engine.film.integrators.bdf2 import bdf2
from toile.engine.film.integrators.explicit_euler import explicit_euler
from toile.engine.film.integrators.integrator import Integrator
from toile.engine.film.integrators.symplectic_euler import symplectic_euler
from toile.engine.step.step import ClothStepper
from toile.geometry.stage_clock import StageClock
from toile.studies.scenes.motion import (
    EXACT,
    LINEARISED,
    Solving,
    carried_on,
    free_options,
    free_stepper,
    total_energy,
)
from toile.studies.scenes.spring_cloth import grid_springs, spring_stepper
from toile.studies.scenes.swing import SECONDS, rms_distance, swing
from toile.studies.speed_error.swing import METHODS, SOLVED, Go, equal, within
from toile.studies.validation.oscillators import loss_per_second, measured_order

EXPLICIT: dict[str, Integrator] = {"explicit Euler": explicit_euler, "symplectic Euler": symplectic_euler}
LONGEST = 0.1
SWING_ENERGY = 0.104 * 9.81 / 2.0
"""What the sheet gains by falling from level to hanging straight [J]."""


@dataclass(frozen=True)
class Scene:
    """A swinging sheet: how to build it, where it is after a second, how sure that is [m]."""

    make: Callable[[], ClothStepper]
    end: np.ndarray
    floor: float


def triangle_scene(cells: int, reference: float) -> Scene:
    cloth = swing(cells)
    return with_reference(lambda: free_stepper(cloth), reference)


def spring_scene(cells: int, reference: float) -> Scene:
    cloth = swing(cells)
    net = grid_springs(1.0, 1.0, cells, cells, fabric("cotton-poplin"))
    return with_reference(
        lambda: spring_stepper(net, cloth.positions, cloth.pinned, free_options()), reference
    )


def with_reference(make: Callable[[], ClothStepper], h: float) -> Scene:
    """The reference takes steps of h [s]; twice that gives the floor."""
    ends = []
    for size in (2 * h, h):
        stepper = make()
        carried_on(stepper, symplectic_euler, SOLVED, SECONDS, size)
        ends.append(stepper.x)
    return Scene(make, ends[1], rms_distance(*ends))


def run(scene: Scene, name: str, repeats: int, go: Go, label: str) -> dict[str, object]:
    """Median CPU time of some runs, building the matrices included, with error and energy lost."""
    times = []
    for _ in range(repeats):
        started = time.process_time()
        stepper = scene.make()
        counts = go(stepper)
        times.append(time.process_time() - started)
    gained = total_energy(stepper) - total_energy(scene.make())
    row = {
        "integrator": name,
        "steps of": label,
        "steps": counts.steps,
        "repeated": counts.retries,
        "newton": counts.newton_iterations,
        "cg": counts.cg_iterations,
        "unsolved": counts.forced,
        "cpu_s": round(median(times), 3),
        "cpu_spread_s": round(max(times) - min(times), 3),
        "rms_m": float(f"{rms_distance(stepper.x, scene.end):.2g}"),
        "energy_lost_percent": round(-100.0 * gained / SWING_ENERGY, 2),
    }
    print(*row.values(), sep="\t", flush=True)
    return row


def is_stable(scene: Scene, integrator: Integrator, solving: Solving, h: float) -> bool:
    """Whether the energy of a second in steps of h stays below its start by 1 % of the swing's."""
    stepper = scene.make()
    allowed = total_energy(stepper) + 0.01 * SWING_ENERGY
    with np.errstate(all="ignore"):
        for step in range(round(SECONDS / h)):
            try:
                carried_on(stepper, integrator, solving, h, h, since=step * h)
            except FloatingPointError:
                return False
            if not total_energy(stepper) < allowed:
                return False
    return True


def largest_stable_step(
    scene: Scene, integrator: Integrator, solving: Solving, longest: float, rounds: int
) -> float:
    """The longest of h, h/1.25, h/1.5625 ... that is stable."""
    h = longest
    for _ in range(rounds):
        if is_stable(scene, integrator, solving, h):
            return h
        h /= 1.25
    return 0.0


def analytic() -> list[dict[str, object]]:
    rows = []
    everything = EXPLICIT | {name: integrator for name, (integrator, _) in METHODS.items()}
    for name, integrator in everything.items():
        linearised = METHODS.get(name, (integrator, EXACT))[1] is LINEARISED
        solving = replace(EXACT, iterations=1) if linearised else EXACT
        row = {
            "integrator": name,
            "order": round(measured_order(integrator, solving), 2),
            "lost_percent_per_s": float(f"{100.0 * loss_per_second(integrator, solving):.3g}"),
        }
        rows.append(row)
        print(*row.values(), sep="\t", flush=True)
    return rows


def models(quick: bool) -> tuple[list[dict[str, object]], dict[str, float]]:
    """All models and integrators on 961 particles."""
    rows, floors = [], {}
    for model, make in (("mass-spring", spring_scene), ("triangles", triangle_scene)):
        scene = make(30, 1.0 / (20_000 if quick else 80_000))
        floors[model] = scene.floor
        print(f"{model}: floor {1e3 * scene.floor:.2f} mm", flush=True)
        for name, integrator in EXPLICIT.items():
            stable = largest_stable_step(scene, integrator, SOLVED, 1.0 / 2000, 14)
            for h in [stable, stable / 2.0, stable / 4.0][: 1 if quick else 3] if stable else []:
                row = run(scene, name, 1, equal(integrator, SOLVED, round(1 / h)), f"1/{1 / h:.0f}")
                rows.append({"model": model, "largest_stable_s": round(stable, 6)} | row)
            if not stable:
                rows.append({"model": model, "integrator": name, "largest_stable_s": 0.0})
        for name, (integrator, solving) in METHODS.items():
            stable = largest_stable_step(scene, integrator, solving, LONGEST, 20)
            for count in (60, 240) if quick else (30, 60, 120, 240, 480):
                row = run(scene, name, 1, equal(integrator, solving, count), f"1/{count}")
                rows.append({"model": model, "largest_stable_s": round(stable, 6)} | row)
    return rows, floors


def swing_study(cells: int, quick: bool, repeats: int) -> tuple[list[dict[str, object]], float]:
    """Error against CPU time of the triangle cloth."""
    scene = triangle_scene(cells, 1.0 / (20_000 if quick else 80_000))
    print(f"swing {cells}: floor {1e3 * scene.floor:.2f} mm", flush=True)
    rows = []
    for count in (10_000,) if quick else (20_000,):
        go = equal(symplectic_euler, SOLVED, count)
        rows.append(run(scene, "symplectic Euler", repeats, go, f"1/{count}"))
    counts = {name: (30, 60, 120, 240, 480) for name in METHODS}
    if not quick:
        counts["Baraff-Witkin"] = counts["backward Euler"] = (60, 240, 960, 1920)
    for name, (integrator, solving) in METHODS.items():
        for count in counts[name]:
            rows.append(run(scene, name, repeats, equal(integrator, solving, count), f"1/{count}"))
    for name in ("BDF2", "TR-BDF2"):
        for rate in (0.1, 0.03, 0.01) if quick else (0.1, 0.03, 0.01, 0.005):
            rows.append(run(scene, name, repeats, within(name, rate), f"error {1e3 * rate:g} mm/s"))
    return rows, scene.floor


def newton_step(cells: int) -> dict[str, object]:
    """CPU time of one Newton step of a hanging, swinging sheet, in milliseconds."""
    cloth = swing(cells)
    stepper = free_stepper(cloth)
    carried_on(stepper, bdf2, SOLVED, 0.5, 1 / 60)
    shares: dict[str, list[float]] = {"energy": [], "forces and matrix": [], "linear solve": []}
    request = LINEARISED.request(1.0 / 60.0, 0.5)
    saved, iterations = stepper.save(), 0
    for _ in range(9):
        started = time.process_time()
        stepper.elastic_energy()
        spent = [time.process_time() - started]
        clock = StageClock()
        stepper.book_on(clock)
        iterations = stepper.step(request).cg_iterations
        spent += [clock.cpu("assembly"), clock.cpu("solve")]
        for share, seconds in zip(shares.values(), spent, strict=True):
            share.append(1e3 * seconds)
        stepper.restore(saved)
    row: dict[str, object] = {"nodes": len(cloth.positions), "cg": iterations}
    row |= {f"{name} ms": round(median(spent), 2) for name, spent in shares.items()}
    row["ms"] = round(sum(median(spent) for spent in shares.values()), 1)
    print(row, flush=True)
    return row


def cpu_at(rows: list[dict[str, object]], name: str, error: float) -> float | None:
    """CPU time [s] at which equal steps reach an error [m], between rows in logarithms."""
    points = [
        (float(row["rms_m"]), float(row["cpu_s"]))  # type: ignore[arg-type]
        for row in rows
        if row["integrator"] == name and "error" not in str(row["steps of"])
    ]
    for (high, before), (low, after) in pairwise(points):
        if low <= error <= high:
            share = np.log(high / error) / np.log(high / low)
            return float(np.exp(np.log(before) + share * np.log(after / before)))
    return None


def rounded(seconds: float | None) -> float | None:
    return None if seconds is None else round(seconds, 2)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="minutes instead of half an hour")
    parser.add_argument("--json", type=Path, metavar="FILE", help="store the figures there only")
    parser.add_argument(
        "--out", type=Path, metavar="FOLDER", help="write integrators.json and integrators.md"
    )
    parser.add_argument(
        "--picture", type=Path, metavar="FILE", help="draw error against CPU time (pip install matplotlib)"
    )
    options = parser.parse_args()
    repeats = 1 if options.quick else 3
    cells = 20 if options.quick else 50
    facts: dict[str, object] = {
        "versions": {"toile": commit(), "Python": platform.python_version(), "numpy": np.__version__},
        "cpu": processor(),
        "analytic": analytic(),
    }
    facts["models"], facts["floors"] = models(options.quick)
    rows, facts["swing_floor"] = swing_study(cells, options.quick, repeats)
    facts["swing"] = rows
    facts["newton"] = newton_step(100)
    facts["equal_error"] = [
        {"rms_m": error} | {f"{name} cpu_s": rounded(cpu_at(rows, name, error)) for name in METHODS}
        for error in (0.06, 0.04, 0.028)
    ]
    if options.json:
        options.json.write_text(json.dumps(facts, indent=1) + "\n")
    if options.out:
        (options.out / "integrators.json").write_text(json.dumps(facts, indent=1) + "\n")
        (options.out / "integrators.md").write_text(page(facts, cells, SWING_ENERGY, LONGEST))
    if options.picture:
        draw(facts, [*EXPLICIT, *METHODS], cells, options.picture)


def commit() -> str:
    done = subprocess.run(
        ["git", "describe", "--always", "--dirty"], capture_output=True, text=True, cwd=Path(__file__).parent
    )
    return done.stdout.strip()


def processor() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


if __name__ == "__main__":
    main()
