"""Adaptive against uniform meshes: CPU time, faces and error of the reference scenes.

Every scene runs on uniform meshes from the finest edges to several times those, on an adaptive mesh between
the finest and twenty times them, and on a uniform reference of half of them. The error is the mean distance
of the surface from the reference, in films the mean over time, or, where the motion is chaotic, the
difference of the drape coefficient; beside it stands how strongly the surface is folded in the end, wherever
its folds lie. The error of a uniform mesh that takes as long as the adaptive one is
read between those of the uniform runs on logarithmic scales.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from itertools import chain
from statistics import mean, median

import numpy as np

from toile.dressing.run.quality import COARSEST
from toile.remesh.sizing.sizing import SizingOptions
from toile.studies.adaptive.fold_turn import fold_turn
from toile.studies.adaptive.surface_distance import mean_surface_distance
from toile.studies.scenes.run import Run, run_film, run_shirt
from toile.studies.scenes.scenes import SCENES

FINEST = {"sphere": 0.0125, "flag": 0.02, "hang": 0.0125, "shirt": 0.010}
"""Finest edges of every scene [m]."""
LADDER, SEWN_LADDER = (1.0, 2.0, 4.0, 8.0), (1.0, 2.0, 3.0)
"""Edges of the uniform meshes, in finest edges, of films and of the shirt, not sewn in coarser ones."""
CHAOTIC = {"sphere", "flag"}
"""Scenes whose folds are chaotic: their drape coefficient is compared."""
START = 4.0
"""Edge length of the mesh that an adaptive film starts from, in finest edges."""
LEAST_ERROR = 1e-12
"""Keeps ratios of errors finite."""
REFINE_ANGLE = {"sphere": 0.7, "flag": 0.25, "hang": 0.07, "shirt": 0.6}
"""Turn of the surface per edge that adaptive meshes aim at [rad]: more where folds are sharp and many."""
REFINE_COMPRESSION = {"sphere": 0.007, "flag": 0.02, "hang": 0.02, "shirt": 0.007}
"""How coarse they stay where cloth is compressed [m]: see `SizingOptions`."""
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
class Rung:
    """A uniform mesh: edge [m], CPU time [s] (the first: median), mean faces, error, distance [mm], turn."""

    edge: float
    cpu: float
    faces: float
    error: float
    distance: float
    turn: float


@dataclass(frozen=True, kw_only=True)
class Row:
    """One scene: adaptive against uniform, as the bars name it, and the figures behind the ratios.

    CPU seconds are medians over the repeats; their spread is longest less shortest over the median. Distances
    are those of the surfaces from the reference, mean over a film [mm], whatever the error is; turns those of
    the last surfaces [rad/m]: see `fold_turn`.
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
    cpu_adaptive: float
    cpu_reference: float
    cpu_spread: float
    faces_adaptive: float
    error_unit: str
    error_adaptive: float
    distance_adaptive: float
    turn_adaptive: float
    turn_reference: float
    uniform: tuple[Rung, ...]

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


def bench_scene(
    name: str, seconds: float | None = None, repeats: int = 1, say: Callable[[str], None] = print
) -> Row:
    """Run one scene in all ways, films for their own length or `seconds`; timed ones `repeats` times.

    `say` gets a line per run.
    """
    finest = FINEST[name]
    sizing = SizingOptions(
        size_min=finest, size_max=COARSEST * finest, refine_angle=REFINE_ANGLE[name],
        refine_compression=REFINE_COMPRESSION[name],
    )  # fmt: skip

    def run(edge: float, adaptive: SizingOptions | None = None) -> Run:
        if name == "shirt":
            one = run_shirt(edge, adaptive)
        else:
            one = run_film(SCENES[name](edge), seconds, adaptive)
        kind = "adaptive" if adaptive else f"uniform {1e3 * edge:g} mm"
        say(f"{name}, {kind}: {one.faces:.0f} faces, {one.cpu:.1f} CPU s, {one.crossings} crossings")
        return one

    edges = [step * finest for step in (SEWN_LADDER if name == "shirt" else LADDER)]
    uniform = [[run(edge) for _ in range(repeats if edge == finest else 1)] for edge in edges]
    adaptive = [run(START * finest, sizing) for _ in range(repeats)]
    reference = run(0.5 * finest)

    def compared(one: Run) -> tuple[float, float]:
        """Error and distance [mm] from the reference."""
        pairs = zip(one.surfaces, reference.surfaces, strict=True)
        distance = 1e3 * mean(mean_surface_distance(*pair) for pair in pairs)
        if name in CHAOTIC:
            return abs(one.drape_coefficient - reference.drape_coefficient), distance
        return distance, distance

    ladder = []
    for edge, runs in zip(edges, uniform, strict=True):
        error, distance = compared(runs[0])
        cpu = median(one.cpu for one in runs)
        turn = fold_turn(*runs[0].surfaces[-1])
        ladder.append(
            Rung(edge=edge, cpu=cpu, faces=runs[0].faces, error=error, distance=distance, turn=turn)
        )
    times = [one.cpu for one in adaptive]
    cpu_adaptive = median(times)
    error_adaptive, distance_adaptive = compared(adaptive[0])
    return Row(
        scene=name,
        cpu_ratio=ladder[0].cpu / cpu_adaptive,
        face_ratio=adaptive[0].faces / ladder[0].faces,
        error_ratio=error_at(ladder, cpu_adaptive) / max(error_adaptive, LEAST_ERROR),
        remesh_share=median(one.remesh_share for one in adaptive),
        energy_jump=adaptive[0].energy_jump,
        energy_drop=adaptive[0].energy_drop,
        crossings=sum(one.crossings for one in (*chain(*uniform), *adaptive, reference)),
        repeats=repeats,
        cpu_adaptive=cpu_adaptive,
        cpu_reference=reference.cpu,
        cpu_spread=(max(times) - min(times)) / cpu_adaptive,
        faces_adaptive=adaptive[0].faces,
        error_unit="drape coefficient" if name in CHAOTIC else "mm",
        error_adaptive=error_adaptive,
        distance_adaptive=distance_adaptive,
        turn_adaptive=fold_turn(*adaptive[0].surfaces[-1]),
        turn_reference=fold_turn(*reference.surfaces[-1]),
        uniform=tuple(ladder),
    )


def error_at(ladder: Sequence[Rung], cpu: float) -> float:
    """Error of a uniform mesh that takes `cpu` [s]; outside of the ladder, that of its nearest end."""
    rungs = sorted(ladder, key=lambda rung: rung.cpu)
    times = np.log([rung.cpu for rung in rungs])
    errors = np.log([max(rung.error, LEAST_ERROR) for rung in rungs])
    return float(np.exp(np.interp(np.log(cpu), times, errors)))


def table(rows: list[Row]) -> str:
    """Return the rows as text, missed bars marked with a star."""
    names = list(BARS)
    lines = ["scene   " + "".join(f"{name:>14}" for name in names)]
    for row in rows:
        values, missed = asdict(row), row.missed()
        cells = "".join(f"{values[name]:>13.3g}{'*' if name in missed else ' '}" for name in names)
        lines += [
            f"{row.scene:8}{cells}",
            f"        adaptive: CPU {row.cpu_adaptive:.1f} s (spread {100 * row.cpu_spread:.0f} %), "
            f"{row.faces_adaptive:.0f} faces, error {row.error_adaptive:.3g} {row.error_unit}, "
            f"distance {row.distance_adaptive:.3g} mm, turn {row.turn_adaptive:.3g} rad/m, "
            f"largest fall of the elastic energy in a remeshing {100 * row.energy_drop:.1f} %; "
            f"reference: CPU {row.cpu_reference:.1f} s, turn {row.turn_reference:.3g} rad/m",
            *(
                f"        uniform {1e3 * rung.edge:g} mm: CPU {rung.cpu:.1f} s, {rung.faces:.0f} faces, "
                f"error {rung.error:.3g} {row.error_unit}, distance {rung.distance:.3g} mm, "
                f"turn {rung.turn:.3g} rad/m"
                for rung in row.uniform
            ),
        ]
    bars = ", ".join(f"{name} {sense} {bar:g}" for name, (bar, sense) in BARS.items())
    own = "; ".join(
        f"{scene}: " + ", ".join(f"{name} {sense} {bar:g}" for name, (bar, sense) in wanted.items())
        for scene, wanted in OWN_BARS.items()
    )
    return "\n".join([*lines, f"bars: {bars} ({own}); * missed"])
