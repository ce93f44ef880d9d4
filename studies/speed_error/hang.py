"""`hang`: a level sheet swings down from two corners; it touches little but itself."""

from collections.abc import Iterator

from toile.studies.scenes.scenes import hang
from toile.studies.speed_error.films import FilmStudy, film_edge
from toile.studies.speed_error.point import Chart, Effort

ANGLES = (0.4, 0.2, 0.1)
"""Of adaptive meshes [rad]."""
STEPS, NEWTON = 480, 4
"""Of the reference: steps per second, and iterations in each."""


def study_hang(effort: Effort) -> Iterator[Chart]:
    """Measure all ways to compute the film."""
    yield FilmStudy("hang", hang, film_edge(effort), ANGLES).chart(effort, STEPS, NEWTON)
