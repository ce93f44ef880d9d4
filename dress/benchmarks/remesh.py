"""Adaptive against uniform meshes: CPU time, faces and error of the reference scenes.

Every scene runs on a uniform mesh of the finest edges, on one of twice those, on an adaptive mesh between
the finest and twenty times them, and on a uniform reference of half of them. The error is the mean distance
of the final surface from the reference, or, where the motion is chaotic, the difference of the drape
coefficient; the error of a uniform mesh that takes as long as the adaptive one follows from the two uniform
runs, on a logarithmic scale.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from math import exp, log
from statistics import median

from toile.dress.benchmarks.run import Run, run_film, run_shirt
from toile.dress.benchmarks.scenes import SCENES
from toile.dress.benchmarks.surface_distance import mean_surface_distance
from toile.dress.quality import COARSEST
from toile.remesh.sizing import SizingOptions

FINEST = {"sphere": 0.0125, "flag": 0.02, "hang": 0.0125, "shirt": 0.010}
"""Finest edges of every scene [m]."""
CHAOTIC = {"flag"}
"""Scenes whose final surface depends on every digit: their drape coefficient is compared."""
START = 4.0
"""Edge length of the mesh that an adaptive film starts from, in finest edges."""
REFINE_ANGLE = 0.5
"""Turn of the surface per edge that adaptive meshes aim at [rad]."""
BARS = {
    "cpu_ratio": (5.0, "at least"),
    "face_ratio": (0.25, "at most"),
    "error_ratio": (2.0, "at least"),
    "remesh_share": (0.10, "at most"),
    "energy_jump": (0.005, "at most"),
    "crossings": (0.0, "at most"),
}
OWN_BARS = {"hang": {"cpu_ratio": (1.0, "at least")}, "shirt": {"cpu_ratio": (3.0, "at least")}}
"""Bars of single scenes, in place of the general ones."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One scene: adaptive against uniform, as the bars name it, and the figures behind the ratios.

    CPU seconds are medians over the repeats; their spread is longest less shortest over the median.
    """

    scene: str
    cpu_ratio: float
    face_ratio: float
    error_ratio: float
    remesh_share: float
    energy_jump: float
    energy_drop: float
    crossings: int
    repeats: int
    cpu_uniform: float
    cpu_coarse: float
    cpu_adaptive: float
    cpu_reference: float
    cpu_spread: float
    faces_uniform: float
    faces_adaptive: float
    error_unit: str
    error_uniform: float
    error_coarse: float
    error_adaptive: float

    def bars(self) -> dict[str, tuple[float, str]]:
        """Return what this scene must reach."""
        return BARS | OWN_BARS.get(self.scene, {})

    def missed(self) -> list[str]:
        """Names of the bars that this scene misses."""
        values = asdict(self)
        return [
            name
            for name, (bar, sense) in self.bars().items()
            if (values[name] < bar if sense == "at least" else values[name] > bar)
        ]


def bench_scene(name: str, seconds: float | None = None, repeats: int = 1) -> Row:
    """Run one scene in all four ways, films for their own length or `seconds`; timed ones `repeats` times."""
    finest = FINEST[name]
    sizing = SizingOptions(size_min=finest, size_max=COARSEST * finest, refine_angle=REFINE_ANGLE)

    def run(edge: float, adaptive: SizingOptions | None = None) -> Run:
        if name == "shirt":
            return run_shirt(edge, adaptive)
        return run_film(SCENES[name](edge), seconds, adaptive)

    uniform = _repeated(lambda: run(finest), repeats)
    adaptive = _repeated(lambda: run(START * finest, sizing), repeats)
    coarse, reference = run(2.0 * finest), run(0.5 * finest)
    cpu_uniform, cpu_adaptive = (median(one.cpu for one in runs) for runs in (uniform, adaptive))

    def error(one: Run) -> float:
        if name in CHAOTIC:
            return abs(one.drape_coefficient - reference.drape_coefficient)
        return 1e3 * mean_surface_distance(one.surface, reference.surface)

    errors = [error(one) for one in (uniform[0], coarse, adaptive[0])]
    slope = log(max(errors[1], 1e-12) / max(errors[0], 1e-12)) / log(coarse.cpu / cpu_uniform)
    as_long = errors[0] * exp(slope * log(cpu_adaptive / cpu_uniform))
    times = [one.cpu for one in adaptive]
    return Row(
        scene=name,
        cpu_ratio=cpu_uniform / cpu_adaptive,
        face_ratio=adaptive[0].faces / uniform[0].faces,
        error_ratio=as_long / max(errors[2], 1e-12),
        remesh_share=median(one.remesh_share for one in adaptive),
        energy_jump=adaptive[0].energy_jump,
        energy_drop=adaptive[0].energy_drop,
        crossings=sum(one.crossings for one in (*uniform, *adaptive, coarse, reference)),
        repeats=repeats,
        cpu_uniform=cpu_uniform,
        cpu_coarse=coarse.cpu,
        cpu_adaptive=cpu_adaptive,
        cpu_reference=reference.cpu,
        cpu_spread=(max(times) - min(times)) / cpu_adaptive,
        faces_uniform=uniform[0].faces,
        faces_adaptive=adaptive[0].faces,
        error_unit="drape coefficient" if name in CHAOTIC else "mm",
        error_uniform=errors[0],
        error_coarse=errors[1],
        error_adaptive=errors[2],
    )


def _repeated(run: Callable[[], Run], repeats: int) -> list[Run]:
    return [run() for _ in range(repeats)]


def table(rows: list[Row]) -> str:
    """Return the rows as text, missed bars marked with a star."""
    names = list(BARS)
    lines = ["scene   " + "".join(f"{name:>14}" for name in names)]
    for row in rows:
        values, missed = asdict(row), row.missed()
        cells = "".join(f"{values[name]:>13.3g}{'*' if name in missed else ' '}" for name in names)
        lines += [
            f"{row.scene:8}{cells}",
            f"        CPU s: uniform {row.cpu_uniform:.1f}, twice the edges {row.cpu_coarse:.1f}, adaptive "
            f"{row.cpu_adaptive:.1f} (spread {100 * row.cpu_spread:.0f} %), "
            f"reference {row.cpu_reference:.1f}; faces: uniform {row.faces_uniform:.0f}, "
            f"adaptive {row.faces_adaptive:.0f}",
            f"        error ({row.error_unit}): uniform {row.error_uniform:.3g}, twice the edges "
            f"{row.error_coarse:.3g}, adaptive {row.error_adaptive:.3g}; largest fall of the elastic energy "
            f"in a remeshing {100 * row.energy_drop:.1f} %",
        ]
    bars = ", ".join(f"{name} {sense} {bar:g}" for name, (bar, sense) in BARS.items())
    own = "; ".join(
        f"{scene}: " + ", ".join(f"{name} {sense} {bar:g}" for name, (bar, sense) in wanted.items())
        for scene, wanted in OWN_BARS.items()
    )
    return "\n".join([*lines, f"bars: {bars} ({own}); * missed"])
