"""`cantilever`: a strip clamped level sags under its weight; the sag is known exactly."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from toile.dressing.garment.fabrics import fabric
from toile.dressing.run.kernels import DRAPE_KERNELS, INTEGRATOR_KERNELS, load_kernels
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Float
from toile.remesh.panel.grid import grid_mesh
from toile.studies.scenes.flat_meshes import KINDS
from toile.studies.scenes.motion import Solving, free_options, free_stepper
from toile.studies.scenes.scenes import sheet
from toile.studies.scenes.spring_cloth import grid_springs, spring_stepper
from toile.studies.speed_error.point import Chart, Effort, Point
from toile.studies.speed_error.timed import timed
from toile.studies.validation.heavy_strip import clamped_strip
from toile.studies.validation.validate_cantilever import ELASTICA, STIFFNESS, WIDTH

GAMMAS = (1.0, 10.0, 100.0)
"""Weight per area L^3 / D: hardly bent, bent, hanging."""
LONG_STEP = 100.0
"""Of the one step in which the strip finds its rest: inertia no longer counts [s]."""
ITERATIONS = 400
SOLVED = Solving(tolerance=1e-6, iterations=ITERATIONS, cg_tolerance=1e-3)
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7)
"""Largest last move over the length, over LONG_STEP."""
CG_TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-6)
EDGES = (10, 20, 40, 80)
"""Per length."""
VARIED = 40
UNIT = replace(
    fabric("cotton-poplin"), areal_density=1.0, bending_warp=1.0, bending_weft=1.0, bending_bias=1.0,
    stretch_warp=STIFFNESS, stretch_weft=STIFFNESS, shear=0.5 * STIFFNESS, compression=1.0,
)  # fmt: skip
"""Of length, rigidity and areal density 1: gravity is Gamma."""

Strip = tuple[Callable[[float], ClothStepper], Float, int]
"""Stepper under a gravity, nodes at the start, shape (n, 3), and number of triangles."""


def study_cantilever(effort: Effort) -> Iterator[Chart]:
    """Measure models, meshes and tolerances."""
    load_kernels((*DRAPE_KERNELS, *INTEGRATOR_KERNELS))
    edges = EDGES[:3] if effort.quick else EDGES
    points = [
        strip_point(effort, f"triangles, {kind} mesh", f"{count} edges", triangles(kind, count), SOLVED)
        for kind in KINDS
        for count in edges
    ]
    points += [strip_point(effort, "springs", f"{count} edges", springs(count), SOLVED) for count in edges]
    for tolerance in TOLERANCES:
        options = replace(SOLVED, tolerance=tolerance)
        points.append(
            strip_point(effort, "Newton tolerance", f"{tolerance:g}", triangles(KINDS[0], VARIED), options)
        )
    for tolerance in CG_TOLERANCES:
        options = replace(SOLVED, cg_tolerance=tolerance)
        points.append(
            strip_point(effort, "linear solver to", f"{tolerance:g}", triangles(KINDS[0], VARIED), options)
        )
    yield Chart(
        scene="cantilever",
        title="models, meshes and tolerances",
        error=f"drop over reach of the tip, worst for Gamma {', '.join(f'{gamma:g}' for gamma in GAMMAS)}",
        unit="%",
        reference="the heavy elastica",
        floor=0.0,
        points=tuple(points),
    )


def triangles(kind: str, count: int) -> Strip:
    """Return a strip of a kind of mesh, with so many edges along it."""
    strip = clamped_strip(kind, WIDTH, 1.0 / count)
    level = np.column_stack((strip.points[:, 0], np.zeros(len(strip.points)), strip.points[:, 1]))
    cloth = sheet(strip.points, strip.faces, level, strip.held, UNIT)
    return lambda gamma: free_stepper(cloth, gravity=gamma), cloth.positions, len(strip.faces)


def springs(count: int) -> Strip:
    """Return a strip of springs on a grid, one column of cells behind the clamp."""
    edge, rows = 1.0 / count, max(2, round(WIDTH * count))
    grid = grid_mesh(1.0 + edge, WIDTH, count + 1, rows)
    net = grid_springs(1.0 + edge, WIDTH, count + 1, rows, UNIT)
    x = np.column_stack((grid.points[:, 0] - edge, np.zeros(len(grid.points)), grid.points[:, 1]))
    held = x[:, 0] < 1e-9
    return lambda gamma: spring_stepper(net, x, held, free_options(gravity=gamma)), x, len(grid.faces)


def strip_point(effort: Effort, curve: str, label: str, strip: Strip, solving: Solving) -> Point:
    """Let a strip sag under more and more weight."""
    found, timing = timed(lambda: _sagged(strip, solving), effort.repeats)
    ratios, iterations = found
    errors = [100.0 * abs(ratio / ELASTICA[gamma] - 1.0) for ratio, gamma in zip(ratios, GAMMAS, strict=True)]
    effort.say(f"cantilever, {curve}, {label}: {max(errors):.3g} %, {timing.cpu:.2f} CPU s")
    by_gamma = {f"Gamma {gamma:g}, %": error for gamma, error in zip(GAMMAS, errors, strict=True)}
    return Point(
        curve=curve, label=label, cpu=timing.cpu, spread=timing.spread, repeats=timing.repeats,
        error=max(errors), faces=strip[2], figures=by_gamma | {"Newton iterations": iterations},
    )  # fmt: skip


def _sagged(strip: Strip, solving: Solving) -> tuple[Sequence[float], int]:
    """Return drop over reach of the tip for all Gammas, and the Newton iterations."""
    make, x, _ = strip
    tip = np.abs(x[:, 0] - 1.0) < 1e-9
    ratios, iterations = [], 0
    for gamma in GAMMAS:
        stepper = make(gamma)
        stepper.put(x, np.zeros_like(x))
        done = stepper.step(solving.request(LONG_STEP, LONG_STEP))
        x, iterations = stepper.x, iterations + done.newton_iterations
        ratios.append(float(-x[tip, 1].mean() / x[tip, 0].mean()))
    return ratios, iterations
