"""`swing`: a sheet without contact, under every integrator, on meshes of triangles and of springs."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import exp, inf, log

import numpy as np

from toile.dressing.garment.fabrics import fabric
from toile.dressing.run.kernels import DRAPE_KERNELS, INTEGRATOR_KERNELS, load_kernels
from toile.engine.film.advance import StepCounts
from toile.engine.film.integrators.backward_euler import backward_euler
from toile.engine.film.integrators.baraff_witkin import baraff_witkin
from toile.engine.film.integrators.bdf2 import bdf2
from toile.engine.film.integrators.integrator import Integrator
from toile.engine.film.integrators.symplectic_euler import symplectic_euler
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float
from toile.studies.scenes.motion import (
    LINEARISED,
    Solving,
    carried_on,
    carried_within,
    free_options,
    free_stepper,
)
from toile.studies.scenes.spring_cloth import grid_springs, spring_stepper
from toile.studies.scenes.swing import SECONDS, rms_distance, swing
from toile.studies.speed_error.mujoco_peer import at_nodes_of, has_mujoco, mujoco_film, mujoco_point
from toile.studies.speed_error.point import Bar, Chart, Effort, Point
from toile.studies.speed_error.timed import timed

SOLVED = Solving(tolerance=0.1)
"""Of implicit steps of equal size: solved better, they end within 2 mm of the same place."""
METHODS: dict[str, tuple[Integrator, Solving]] = {
    "Baraff-Witkin": (baraff_witkin, LINEARISED),
    "backward Euler": (backward_euler, SOLVED),
    "BDF2": (bdf2, SOLVED),
    "TR-BDF2": (tr_bdf2, SOLVED),
}
"""Implicit integrators, and how exactly their steps are solved."""
EQUAL_STEPS = {
    "Baraff-Witkin": (60, 240, 960, 1920),
    "backward Euler": (60, 240, 960, 1920),
    "BDF2": (30, 60, 120, 240, 480),
    "TR-BDF2": (30, 60, 120, 240, 480),
}
"""Steps per second."""
RATES = (0.1, 0.03, 0.01, 0.005)
"""Errors per second of steps that follow the error [m/s]."""
SHARED = 10
"""Cells of the grid whose nodes all meshes have."""
UNFOLDED = 0.5
"""After this the sheet folds up, and the smallest difference grows [s]."""
EXACT_RATE = 2e-3
"""Error per second of the reference of the meshes [m/s]."""
REFERENCE_STEPS = 960
"""Steps per second of TR-BDF2 that serve as reference: half as many end 2 mm off with 50 x 50 cells."""
EXACT = Solving(cg_tolerance=1e-3)
"""Of the reference."""
PEER_STEPS = (0.004, 0.002)
"""Steps of MuJoCo [s], first order: with 1 ms it is still centimetres off."""
WANTED, TIME_BAR, RATIO_BAR = 0.002, 1.5, 5.0
"""Bars: error [m] within so many CPU s; CPU time of backward Euler over that of TR-BDF2 at equal error."""

Go = Callable[[ClothStepper], StepCounts]
"""Takes a stepper along."""


@dataclass(frozen=True)
class Sheet:
    """A swinging sheet: how to build it anew at its start, its triangles, where it is after a second [m]."""

    make: Callable[[], ClothStepper]
    faces: int
    end: Float

    def point(self, effort: Effort, curve: str, label: str, go: Go, error: Callable[[Float], float]) -> Point:
        """Run once or more, matrices built anew; `error` [m] judges the end."""

        def once() -> tuple[StepCounts, Float] | None:
            stepper = self.make()
            try:
                return go(stepper), stepper.x
            except FloatingPointError:
                return None

        done, timing = timed(once, effort.repeats)
        off = inf if done is None else 1e3 * error(done[1])
        effort.say(f"swing, {curve}, {label}: {off:.3g} mm, {timing.cpu:.2f} CPU s")
        figures = {}
        if done is not None:
            counts = done[0]
            figures = {
                "steps": counts.steps,
                "Newton iterations": counts.newton_iterations,
                "CG": counts.cg_iterations,
            }
        return Point(
            curve=curve, label=label, cpu=timing.cpu, spread=timing.spread, repeats=timing.repeats,
            error=off, faces=self.faces, figures=figures,
        )  # fmt: skip

    def advanced(self, go: Go) -> Float:
        """Return where nodes are at the end [m], shape (n, 3)."""
        stepper = self.make()
        go(stepper)
        return stepper.x


def study_swing(effort: Effort) -> Iterator[Chart]:
    """Measure integrators on one mesh, then meshes."""
    load_kernels((*DRAPE_KERNELS, *INTEGRATOR_KERNELS))
    yield _integrators(effort)
    yield _meshes(effort)


def equal(integrator: Integrator, solving: Solving, count: int) -> Go:
    """Return an advance in equal steps of 1/count s."""
    return lambda stepper: carried_on(stepper, integrator, solving, SECONDS, 1.0 / count)


def within(name: str, rate: float, seconds: float = SECONDS) -> Go:
    """Return an advance in steps that add an error of `rate` [m/s]."""
    integrator = METHODS[name][0]
    return lambda stepper: carried_within(stepper, integrator, seconds, rate)


def triangles(cells: int, reference: int = 0) -> Sheet:
    """Return the sheet of triangles on cells x cells; with where `reference` steps of TR-BDF2 take it."""
    cloth = swing(cells)
    end = cloth.positions
    if reference:
        stepper = free_stepper(cloth)
        equal(tr_bdf2, EXACT, reference)(stepper)
        end = stepper.x
    return Sheet(lambda: free_stepper(cloth), len(cloth.faces), end)


def springs(cells: int) -> Sheet:
    """Return the sheet of springs on cells x cells."""
    cloth = swing(cells)
    net = grid_springs(1.0, 1.0, cells, cells, fabric("cotton-poplin"))
    return Sheet(
        lambda: spring_stepper(net, cloth.positions, cloth.pinned, free_options()), len(net.faces),
        cloth.positions,
    )  # fmt: skip


def _integrators(effort: Effort) -> Chart:
    """Error against time over step sizes and error targets."""
    cells, steps = 20 if effort.quick else 50, REFERENCE_STEPS
    sheet = triangles(cells, steps)
    coarse = sheet.advanced(equal(tr_bdf2, EXACT, steps // 2))
    effort.say(f"swing: reference of {cells} x {cells} cells is done")

    def error(x: Float) -> float:
        return rms_distance(x, sheet.end)

    points = []
    for name, (integrator, solving) in METHODS.items():
        for count in EQUAL_STEPS[name][:3] if effort.quick else EQUAL_STEPS[name]:
            go = equal(integrator, solving, count)
            points.append(sheet.point(effort, f"{name}, equal steps", f"1/{count} s", go, error))
    for name in ("BDF2", "TR-BDF2"):
        for rate in RATES[:3] if effort.quick else RATES:
            label = f"{1e3 * rate:g} mm/s"
            points.append(sheet.point(effort, f"{name}, by the error", label, within(name, rate), error))
    explicit = 10_000 if effort.quick else 20_000
    points.append(
        sheet.point(
            effort, "symplectic Euler, equal steps", f"1/{explicit} s",
            equal(symplectic_euler, SOLVED, explicit), error,
        )
    )  # fmt: skip
    if not effort.quick and has_mujoco(effort.say, "swing"):
        points += _peers(effort, cells, error)
    return Chart(
        scene="swing",
        title=f"time steps, {cells} x {cells} cells",
        error="root mean square distance of the nodes after 1 s",
        unit="mm",
        reference=f"TR-BDF2 in steps of 1/{steps} s",
        floor=1e3 * rms_distance(coarse, sheet.end),
        points=tuple(points),
        bars=() if effort.quick else _bars(points),
    )


def _peers(effort: Effort, cells: int, error: Callable[[Float], float]) -> Iterator[Point]:
    """Measure MuJoCo, on the same grid."""
    for step in PEER_STEPS:
        film = mujoco_film("swing", cells, SECONDS, step)
        off = 1e3 * error(at_nodes_of(swing(cells).positions, film))
        effort.say(f"swing, MuJoCo, {1e3 * step:g} ms: {off:.3g} mm, {film.cpu:.1f} CPU s")
        yield mujoco_point(film, step, off, 0, cells)


def _bars(points: Sequence[Point]) -> tuple[Bar, ...]:
    """Return what the integrators must reach."""
    quick = [point.error for point in points if point.cpu <= TIME_BAR]
    ratios = time_ratios(points, "backward Euler, equal steps", "TR-BDF2, equal steps")
    return (
        Bar(
            claim=f"least error [mm] within {TIME_BAR:g} CPU s", value=min(quick, default=inf),
            limit=1e3 * WANTED,
        ),
        Bar(
            claim="CPU time of backward Euler over that of TR-BDF2 at equal error, least where both are "
            "measured (0: never as exact)",
            value=min(ratios, default=0.0), limit=RATIO_BAR, at_least=True,
        ),
    )  # fmt: skip


def time_ratios(points: Sequence[Point], slow: str, fast: str) -> list[float]:
    """Return CPU time of one curve over that of another, at every error of either that both bracket.

    Where the fast one is nearer at its first point than the slow one at its last, those two bound the ratio
    from below.
    """
    curves = [[point for point in points if point.curve == name] for name in (slow, fast)]
    ratios = []
    for point in (*curves[0], *curves[1]):
        there = [time_at(curve, point.error) for curve in curves]
        if there[0] is not None and there[1] is not None:
            ratios.append(there[0] / there[1])
    if not ratios and curves[0] and curves[1] and curves[1][0].error <= curves[0][-1].error:
        ratios.append(curves[0][-1].cpu / curves[1][0].cpu)
    return ratios


def time_at(curve: Sequence[Point], error: float) -> float | None:
    """Return the CPU time [s] at which a curve first gets to an error, between points in logarithms."""
    for before, after in pairwise(curve):
        if after.error <= error <= before.error and after.error < before.error:
            share = log(before.error / error) / log(before.error / after.error)
            return exp(log(before.cpu) + share * log(after.cpu / before.cpu))
    return None


def _meshes(effort: Effort) -> Chart:
    """Error against time over mesh sizes, of triangles and of springs, at the nodes that all meshes share."""
    finest = 60 if effort.quick else 100
    ladder = (10, 20) if effort.quick else (10, 20, 30, 40, 50)
    go = within("BDF2", EXACT_RATE, UNFOLDED)
    end = _shared(triangles(finest).advanced(go))
    coarser = _shared(triangles(finest // 2).advanced(go))
    effort.say(f"swing: reference of {finest} x {finest} cells is done")

    def error(x: Float) -> float:
        return rms_distance(_shared(x), end)

    points = [
        make(cells).point(effort, name, f"{cells} x {cells}", within("BDF2", RATES[2], UNFOLDED), error)
        for name, make in (("triangles", triangles), ("springs", springs))
        for cells in ladder
    ]
    return Chart(
        scene="swing",
        title="meshes and models",
        error=f"root mean square distance after {UNFOLDED:g} s at the nodes of {SHARED} x {SHARED} cells",
        unit="mm",
        reference=f"triangles on {finest} x {finest} cells, BDF2 within {1e3 * EXACT_RATE:g} mm/s",
        floor=1e3 * rms_distance(coarser, end),
        points=tuple(points),
    )


def _shared(x: Float) -> Float:
    """Return the nodes that all meshes have [m], shape (m, 3), of a square grid of nodes (n, 3)."""
    side = round(len(x) ** 0.5)
    every = (side - 1) // SHARED
    return np.ascontiguousarray(x.reshape(side, side, 3)[::every, ::every].reshape(-1, 3))
