"""Adaptive against uniform meshes: CPU time, faces and error of the reference scenes.

Every scene runs on a uniform mesh of the finest edges, on one of twice those, on an adaptive mesh between
the finest and twenty times them, and on a uniform reference of half of them. The error is the mean distance
of the final surface from the reference; the error of a uniform mesh that takes as long as the adaptive one
follows from the two uniform runs, on a logarithmic scale.
"""

from dataclasses import asdict, dataclass
from math import exp, log
from time import process_time

import numpy as np

from toile.dress.benchmarks.scenes import SCENES, BenchmarkScene
from toile.dress.benchmarks.surface_distance import mean_surface_distance
from toile.dress.quality import COARSEST
from toile.engine.remeshing import remeshed
from toile.engine.simulate import Simulation
from toile.geometry.arrays import Float, Int
from toile.remesh.sizing import SizingOptions

FINEST = {"sphere": 0.02, "flag": 0.025, "hang": 0.02}
"""Finest edges of every scene [m]."""
EVERY = 3
"""Frames between two remeshings."""
START = 4.0
"""Edge length of the mesh that an adaptive film starts from, in finest edges."""
BARS = {
    "cpu_ratio": (5.0, "at least"),
    "face_ratio": (0.25, "at most"),
    "error_ratio": (2.0, "at least"),
    "remesh_share": (0.10, "at most"),
    "energy_jump": (0.005, "at most"),
    "crossings": (0.0, "at most"),
}


@dataclass(frozen=True, kw_only=True)
class Run:
    """One film: CPU seconds, mean faces, crossings in all frames, share of remeshing, largest energy jump."""

    cpu: float
    faces: float
    crossings: int
    remesh_share: float
    energy_jump: float
    surface: tuple[Float, Int]


@dataclass(frozen=True, kw_only=True)
class Row:
    """One scene: adaptive against uniform, as the bars name it, and the figures behind the ratios."""

    scene: str
    cpu_ratio: float
    face_ratio: float
    error_ratio: float
    remesh_share: float
    energy_jump: float
    crossings: int
    cpu_uniform: float
    cpu_adaptive: float
    error_uniform_mm: float
    error_coarse_mm: float
    error_adaptive_mm: float

    def missed(self) -> list[str]:
        """Names of the bars that this scene misses."""
        values = asdict(self)
        return [
            name
            for name, (bar, sense) in BARS.items()
            if (values[name] < bar if sense == "at least" else values[name] > bar)
        ]


def bench_scene(name: str, seconds: float | None = None) -> Row:
    """Run one scene in all four ways, for its own length or `seconds`."""
    finest = FINEST[name]
    scene = SCENES[name]
    uniform = film(scene(finest), seconds)
    coarse = film(scene(2.0 * finest), seconds)
    sizing = SizingOptions(size_min=finest, size_max=COARSEST * finest)
    adaptive = film(scene(START * finest), seconds, sizing)
    reference = film(scene(0.5 * finest), seconds)
    errors = [mean_surface_distance(run.surface, reference.surface) for run in (uniform, coarse, adaptive)]
    slope = log(errors[1] / errors[0]) / log(coarse.cpu / uniform.cpu)
    as_long = errors[0] * exp(slope * log(adaptive.cpu / uniform.cpu))
    return Row(
        scene=name,
        cpu_ratio=uniform.cpu / adaptive.cpu,
        face_ratio=adaptive.faces / uniform.faces,
        error_ratio=as_long / errors[2],
        remesh_share=adaptive.remesh_share,
        energy_jump=adaptive.energy_jump,
        crossings=uniform.crossings + coarse.crossings + adaptive.crossings + reference.crossings,
        cpu_uniform=uniform.cpu,
        cpu_adaptive=adaptive.cpu,
        error_uniform_mm=1e3 * errors[0],
        error_coarse_mm=1e3 * errors[1],
        error_adaptive_mm=1e3 * errors[2],
    )


def film(scene: BenchmarkScene, seconds: float | None, sizing: SizingOptions | None = None) -> Run:
    """Run a scene, on an adaptive mesh if `sizing` says how."""
    jumps = [0.0]

    def adapt(run: Simulation) -> None:
        if (len(run.record.crossings) - 1) % EVERY or sizing is None:
            return
        before = run.stepper.elastic_energy()
        found = remeshed(run.cloth, run.stepper, sizing)
        if found is None:
            return
        run.restart(found.cloth, found.anchors)
        if before > 0.0:
            jumps.append(run.stepper.elastic_energy() / before - 1.0)

    started = process_time()
    run = Simulation(scene.cloth, scene.avatar, scene.plan, lambda _: True, adapt if sizing else None)
    record = run.run(seconds or scene.seconds)
    cpu = process_time() - started
    return Run(
        cpu=cpu,
        faces=float(np.mean(record.faces)),
        crossings=sum(map(sum, record.crossings)),
        remesh_share=run.clock.seconds.get("remesh", 0.0) / cpu,
        energy_jump=max(jumps),
        surface=(run.stepper.x.copy(), run.stepper.faces),
    )


def table(rows: list[Row]) -> str:
    """Return the rows as text, missed bars marked with a star."""
    names = list(BARS)
    lines = [
        "scene    " + "".join(f"{name:>14}" for name in names) + "   CPU s uniform / adaptive   error mm"
    ]
    for row in rows:
        values, missed = asdict(row), row.missed()
        cells = "".join(f"{values[name]:>13.3g}{'*' if name in missed else ' '}" for name in names)
        lines.append(
            f"{row.scene:9}{cells}   {row.cpu_uniform:8.1f} / {row.cpu_adaptive:<8.1f}"
            f"   {row.error_uniform_mm:.2f}, coarse {row.error_coarse_mm:.2f}, "
            f"adaptive {row.error_adaptive_mm:.2f}"
        )
    bars = ", ".join(f"{name} {sense} {bar:g}" for name, (bar, sense) in BARS.items())
    return "\n".join([*lines, f"bars: {bars}; * missed"])
