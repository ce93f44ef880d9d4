"""`hang`: a level sheet swings down from two corners; it touches little but itself."""

from collections.abc import Iterator

from toile.dress.benchmarks.report.films import FilmStudy, film_edge
from toile.dress.benchmarks.report.point import Chart, Effort
from toile.dress.benchmarks.scenes import hang

ANGLES = (0.4, 0.2, 0.1)
"""Of adaptive meshes [rad]."""
STEPS, NEWTON = 480, 4
"""Of the reference: steps per second, and iterations in each."""


def study_hang(effort: Effort) -> Iterator[Chart]:
    """Measure all ways to compute the film."""
    yield FilmStudy("hang", hang, film_edge(effort), ANGLES).chart(effort, STEPS, NEWTON)
