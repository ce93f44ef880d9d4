"""`sphere`: a sheet falls on a sphere, folds and touches itself."""

from collections.abc import Iterator
from dataclasses import replace

from toile.studies.scenes.scenes import sphere
from toile.studies.speed_error.films import FilmStudy, Way, film_edge
from toile.studies.speed_error.point import Bar, Chart, Effort
from toile.studies.speed_error.timed import repeated

ANGLES = (0.8, 0.4)
"""Of adaptive meshes [rad]."""
STEPS = 240
"""Of the reference: contacts come and go, and steps solved well would end in shortest ones only."""
CELL, BAR_SECONDS, TIME_BAR = 0.02, 2.0, 5.0
"""Of the bar: edges [m] of 50 x 50, length of the film [s], CPU s per simulated second."""


def study_sphere(effort: Effort) -> Iterator[Chart]:
    """Measure all ways to compute the film."""
    study = FilmStudy("sphere", sphere, film_edge(effort), ANGLES)
    chart = study.chart(effort, STEPS, None)
    yield chart if effort.quick else replace(chart, bars=_bars(study, effort))


def _bars(study: FilmStudy, effort: Effort) -> tuple[Bar, ...]:
    """Return what the sheet of 50 x 50 must reach in a film of two seconds."""
    run, timing = repeated(
        lambda: study.clocked(Way("bar", "", CELL, lambda plan: plan), BAR_SECONDS), effort.repeats
    )
    audited = timing.cpu / BAR_SECONDS
    claim = "CPU s per simulated second, edges of 20 mm, self-contact, 2 s"
    return (
        Bar(claim=f"{claim}, every frame audited", value=audited, limit=TIME_BAR),
        Bar(claim=f"{claim}, without the audit", value=(1.0 - run.audit_share) * audited, limit=TIME_BAR),
        Bar(claim="crossings in that film", value=run.crossings, limit=0.0),
    )
