"""Films with contact, varied in mesh, time step, solver and contact; shared by `hang` and `sphere`."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf
from statistics import mean
from typing import NamedTuple

from toile.dressing.run.quality import COARSEST
from toile.engine.film.integrators.backward_euler import backward_euler
from toile.engine.film.integrators.integrator import Integrator
from toile.engine.film.integrators.tr_bdf2 import tr_bdf2
from toile.engine.film.plan import PUSHED_NEWTON, PUSHED_RISE, PUSHED_TOLERANCE, FilmPlan
from toile.engine.solve.linear_system import LinearSystem
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.engine.solve.preconditioner.block_jacobi import BlockJacobi
from toile.engine.solve.preconditioner.gauss_seidel import SymmetricGaussSeidel
from toile.engine.solve.preconditioner.two_level import TwoLevel
from toile.remesh.sizing.sizing import SizingOptions
from toile.studies.adaptive.surface_distance import mean_surface_distance
from toile.studies.scenes.run import Run, run_film
from toile.studies.scenes.scenes import BenchmarkScene
from toile.studies.speed_error.point import Chart, Effort, Point
from toile.studies.speed_error.timed import Timing, repeated

Change = Callable[[FilmPlan], FilmPlan]
Preconditioning = Callable[[LinearSystem], Preconditioner]
SECONDS = 1.0
"""Length of the films [s]: swinging down or draping, and a good part of coming to rest."""
INTEGRATORS: dict[str, Integrator] = {"backward Euler": backward_euler, "TR-BDF2": tr_bdf2}
STEPS = (60, 120, 240)
"""Longest steps, per second; with them goes how far a node may move in a step."""
PRECONDITIONERS: dict[str, Preconditioning] = {
    "block Jacobi": lambda system: BlockJacobi(),
    "Gauss-Seidel": lambda system: SymmetricGaussSeidel(system.pattern),
    "two levels": lambda system: TwoLevel(system),
}
CG_TOLERANCES = (1e-1, 1e-2, 1e-3)
NEWTON = (1, 2, 4)
"""Iterations per step, to PUSHED_TOLERANCE."""
STIFFNESS = (0.1, 1.0, 10.0)
"""Of contact, over that of the scene."""


def in_steps(count: int, integrator: Integrator) -> Change:
    """Return what makes a plan's longest step 1/count s; nodes may move as far as it asks for.

    TR-BDF2 takes the iterations that films of garments do: with one it is not stable on fine meshes. So it
    does with how far stretch may rise.
    """

    def change(plan: FilmPlan) -> FilmPlan:
        factor = 1.0 / (count * plan.longest_step)
        if integrator is tr_bdf2:
            plan = replace(
                plan, newton=PUSHED_NEWTON, newton_tolerance=PUSHED_TOLERANCE, stretch_rise=PUSHED_RISE
            )
        return replace(
            plan, integrator=integrator, longest_step=factor * plan.longest_step,
            shortest_step=min(1.0, factor) * plan.shortest_step, motion_max=factor * plan.motion_max,
        )  # fmt: skip

    return change


BASE = in_steps(120, tr_bdf2)
"""What every way does unless it says otherwise."""


class Way(NamedTuple):
    """A way to compute a film: its point's curve and label, mesh [m], and what differs from the plan."""

    curve: str
    label: str
    edge: float
    change: Change = BASE
    sizing: SizingOptions | None = None
    preconditioning: Preconditioning | None = None


@dataclass(frozen=True)
class FilmStudy:
    """A scene by edge length [m], the edge of most points, and angles of adaptive meshes [rad]."""

    name: str
    scene: Callable[[float], BenchmarkScene]
    edge: float
    angles: tuple[float, ...]

    def run(self, way: Way, seconds: float = SECONDS) -> Run:
        """Compute the film in one way."""
        scene = self.scene(way.edge)
        return run_film(scene._replace(plan=way.change(scene.plan)), seconds, way.sizing, way.preconditioning)

    def clocked(self, way: Way, seconds: float = SECONDS) -> tuple[Run, float]:
        """Compute the film; return it and its CPU time, meshing aside [s]."""
        run = self.run(way, seconds)
        return run, run.cpu

    def point(self, effort: Effort, way: Way, reference: Run) -> Point:
        """Compute the film, more than once where that is quick, and compare it with the reference."""
        run, timing = repeated(lambda: self.clocked(way), effort.repeats)
        point = self.point_of(way.curve, way.label, run, timing, reference)
        effort.say(
            f"{self.name}, {way.curve}, {way.label}: {point.error:.3g} mm, {timing.cpu:.1f} CPU s, "
            f"{run.crossings} crossings"
        )
        return point

    def point_of(
        self, curve: str, label: str, run: Run, timing: Timing, reference: Run, seconds: float = SECONDS
    ) -> Point:
        """Compare a film of a length [s] with the reference."""
        error = distance(run, reference)
        return Point(
            curve=curve, label=label, cpu=timing.cpu, spread=timing.spread, repeats=timing.repeats,
            error=error, faces=run.faces, crossings=run.crossings,
            figures={
                "CPU s per simulated s": timing.cpu / seconds,
                "without the audit": (1.0 - run.audit_share) * timing.cpu / seconds,
                "strain max %": 100.0 * run.strain_max,
                "shadow off by": abs(run.drape_coefficient - reference.drape_coefficient),
                "steps": run.steps,
            },
        )  # fmt: skip

    def chart(self, effort: Effort, steps: int, newton: int | None) -> Chart:
        """Compute the film in all ways, and in so many steps per second and iterations on half the edges."""
        edge = 0.5 * self.edge
        finest = exactly(edge, steps, newton)
        reference = self.run(finest)
        coarse = self.run(exactly(2.0 * edge, steps // 2, newton))
        effort.say(f"{self.name}: reference is done, {reference.cpu:.0f} CPU s")
        return Chart(
            scene=self.name,
            title="meshes, steps, solvers and contact",
            error="mean distance of the surface, mean over 1 s of film",
            unit="mm",
            reference=f"{finest.label}, {reference.cpu:.0f} CPU s",
            floor=distance(coarse, reference),
            points=tuple(self.point(effort, way, reference) for way in self.ways(effort)),
        )

    def ways(self, effort: Effort) -> Iterator[Way]:
        """Return all ways: one thing is varied at a time, the others are those of BASE."""
        edge, quick = self.edge, effort.quick
        for name, integrator in INTEGRATORS.items():
            for count in STEPS[1:] if quick else STEPS:
                yield Way(f"{name}, longest step", f"1/{count} s", edge, in_steps(count, integrator))
        for factor in (2.0, 1.0) if quick else (4.0, 2.0, 1.0, 0.5):
            yield Way("uniform meshes", f"{1e3 * factor * edge:g} mm", factor * edge)
        finest = edge if quick else 0.5 * edge
        for angle in self.angles[:1] if quick else self.angles:
            sizing = SizingOptions(size_min=finest, size_max=COARSEST * finest, refine_angle=angle)
            yield Way("adaptive meshes", f"{angle:g} rad, {1e3 * finest:g} mm", 4.0 * finest, sizing=sizing)
        if quick:
            return
        for newton in NEWTON:
            yield Way("Newton iterations", f"{newton}", edge, also(newton=newton))
        for tolerance in CG_TOLERANCES:
            yield Way("linear solver to", f"{tolerance:g}", edge, also(cg_tolerance=tolerance))
        for name, preconditioning in PRECONDITIONERS.items():
            yield Way("preconditioner", name, edge, preconditioning=preconditioning)
        for factor in STIFFNESS:
            yield Way("contact stiffness", f"{factor:g} x", edge, _pressing(factor))
        yield Way("cloth passes through itself", "no self-contact", edge, _passing)


def film_edge(effort: Effort) -> float:
    """Edge of most points [m]."""
    return 0.05 if effort.quick else 0.025


def distance(run: Run, reference: Run) -> float:
    """Return the mean distance of the surfaces from those of the reference [mm], mean over the film."""
    if len(run.surfaces) < len(reference.surfaces):
        return inf
    pairs = zip(run.surfaces, reference.surfaces, strict=True)
    return 1e3 * mean(mean_surface_distance(*pair) for pair in pairs)


def exactly(edge: float, count: int, newton: int | None) -> Way:
    """Return the way of references: TR-BDF2 in 1/count s steps, solved well or as films of garments are."""
    fine = in_steps(count, tr_bdf2)
    solved = "" if newton is None else f", {newton} Newton iterations"

    def change(plan: FilmPlan) -> FilmPlan:
        found = replace(fine(plan), cg_tolerance=1e-3)
        if newton is None:
            return found
        return replace(found, newton=newton, newton_tolerance=plan.newton_tolerance)

    return Way("reference", f"{1e3 * edge:g} mm, TR-BDF2 in steps of 1/{count} s{solved}", edge, change)


def also(*, newton: int = PUSHED_NEWTON, cg_tolerance: float = 1e-2) -> Change:
    """Return what makes a plan BASE with other limits of its iterations."""
    return lambda plan: replace(BASE(plan), newton=newton, cg_tolerance=cg_tolerance)


def _pressing(factor: float) -> Change:
    def change(plan: FilmPlan) -> FilmPlan:
        step = plan.step
        laws = [replace(law, stiffness=factor * law.stiffness) for law in (step.law_body, step.law_self)]
        return replace(BASE(plan), step=replace(step, law_body=laws[0], law_self=laws[1]))

    return change


def _passing(plan: FilmPlan) -> FilmPlan:
    return replace(BASE(plan), step=replace(plan.step, self_contact=False))
