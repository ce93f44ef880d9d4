"""`hang`: a level sheet swings down from two corners; it touches little but itself."""

from collections.abc import Iterator

from toile.dress.benchmarks.report.films import FilmStudy, distance, exactly
from toile.dress.benchmarks.report.point import Chart, Effort
from toile.dress.benchmarks.scenes import hang

ANGLES = (0.4, 0.2, 0.1)
"""Of adaptive meshes [rad]."""
NEWTON = 4
"""Iterations per step of the reference."""


def study_hang(effort: Effort) -> Iterator[Chart]:
    """Measure all ways to compute the film."""
    study = FilmStudy("hang", hang, 0.05 if effort.quick else 0.025, ANGLES)
    edge, count = 0.5 * study.edge, 480
    finest = exactly(edge, count, NEWTON)
    reference = study.run(finest)
    coarse = study.run(exactly(2.0 * edge, count // 2, NEWTON))
    effort.say(f"hang: reference is done, {reference.cpu:.0f} CPU s")
    yield Chart(
        scene="hang",
        title="meshes, steps, solvers and contact",
        error="mean distance of the surface, mean over 1 s of film",
        unit="mm",
        reference=f"{finest.label}, {reference.cpu:.0f} CPU s",
        floor=distance(coarse, reference),
        points=tuple(study.point(effort, way, reference) for way in study.ways(effort)),
    )
