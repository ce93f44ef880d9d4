"""`sphere`: a sheet falls on a sphere, folds and touches itself."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf

from toile.studies.adaptive.surface_distance import mean_surface_distance
from toile.studies.scenes.run import SAMPLED, Run
from toile.studies.scenes.scenes import sphere
from toile.studies.speed_error.films import FilmStudy, Way, distance, exactly, film_edge
from toile.studies.speed_error.mujoco_peer import (
    FRAME_SECONDS,
    MujocoFilm,
    crossings_in_all,
    has_mujoco,
    mujoco_film,
    mujoco_point,
)
from toile.studies.speed_error.point import Bar, Chart, Effort
from toile.studies.speed_error.timed import repeated

ANGLES = (0.8, 0.4)
"""Of adaptive meshes [rad]."""
STEPS = 240
"""Of the reference: contacts come and go, and steps solved well would end in shortest ones only."""
BAR_SECONDS = 2.0
"""Length of the films of the bars [s]."""
BARS = {0.02: (2.0, 1.4), 0.01: (8.0, inf)}
"""By edge length [m], of 50 x 50 and 100 x 100: CPU s per simulated second, audited and without."""
PEER_CELLS, PEER_STEP = 50, 0.004
"""Of MuJoCo: cells along a side, and its step [s]."""


def study_sphere(effort: Effort) -> Iterator[Chart]:
    """Measure all ways to compute the film, and in full MuJoCo beside toile."""
    study = FilmStudy("sphere", sphere, film_edge(effort), ANGLES)
    chart = study.chart(effort, STEPS, None)
    if effort.quick:
        yield chart
        return
    yield replace(chart, bars=tuple(bar for edge in BARS for bar in _bars(study, effort, edge)))
    if has_mujoco(effort.say, "sphere"):
        yield _beside_mujoco(study, effort)


def _bars(study: FilmStudy, effort: Effort, edge: float) -> Iterator[Bar]:
    """Return what a sheet of edges `edge` [m] must reach in a film of two seconds."""
    run, timing = repeated(
        lambda: study.clocked(Way("bar", "", edge, lambda plan: plan), BAR_SECONDS), effort.repeats
    )
    audited = timing.cpu / BAR_SECONDS
    claim = f"CPU s per simulated second, edges of {1e3 * edge:g} mm, self-contact, 2 s"
    limits = BARS[edge]
    yield Bar(claim=f"{claim}, every frame audited", value=audited, limit=limits[0])
    if limits[1] < inf:
        without = (1.0 - run.audit_share) * audited
        yield Bar(claim=f"{claim}, without the audit", value=without, limit=limits[1])
    yield Bar(claim=f"crossings in the film of {1e3 * edge:g} mm", value=run.crossings, limit=0.0)


def _beside_mujoco(study: FilmStudy, effort: Effort) -> Chart:
    """Measure toile and MuJoCo's penetration-free mode on meshes of one edge length, over two seconds."""
    edge = 1.0 / PEER_CELLS
    finest = exactly(0.5 * edge, STEPS, None)
    reference = study.run(finest, BAR_SECONDS)
    coarse = study.run(exactly(edge, STEPS // 2, None), BAR_SECONDS)
    own, timing = repeated(
        lambda: study.clocked(Way("toile", "", edge, lambda plan: plan), BAR_SECONDS), effort.repeats
    )
    film = mujoco_film("sphere", PEER_CELLS, BAR_SECONDS, PEER_STEP)
    off = _film_distance(film, reference)
    effort.say(f"sphere, MuJoCo: {off:.3g} mm, {film.cpu:.1f} CPU s")
    toile = study.point_of("toile", "its film, audited", own, timing, reference, BAR_SECONDS)
    peer = mujoco_point(film, PEER_STEP, off, crossings_in_all(film, sphere(edge).avatar), PEER_CELLS)
    return Chart(
        scene="sphere",
        title="beside MuJoCo",
        error="mean distance of the surface, mean over 2 s of film; MuJoCo's is frictionless and as stiff in "
        "compression",
        unit="mm",
        reference=f"{finest.label}, {reference.cpu:.0f} CPU s",
        floor=distance(coarse, reference),
        points=(toile, peer),
    )


def _film_distance(film: MujocoFilm, reference: Run) -> float:
    """Mean distance of the surfaces of a film from those of the reference [mm], mean over the film."""
    every = round(SAMPLED / FRAME_SECONDS)
    pairs = zip(film.positions[every::every], reference.surfaces, strict=True)
    apart = [mean_surface_distance((x, film.faces), surface) for x, surface in pairs]
    return 1e3 * sum(apart) / len(apart)
