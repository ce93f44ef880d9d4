"""The description of a hard case."""

from dataclasses import dataclass, replace

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.engine.film.plan import PUSHED_NEWTON, PUSHED_TOLERANCE, FilmPlan
from toile.geometry.arrays import Float, Int
from toile.studies.scenes.scenes import film_plan

FPS = 24.0


def pushed_plan() -> FilmPlan:
    """Return the plan of a film of cloth that is pushed or pulled hard."""
    return replace(
        film_plan(), frame_seconds=1.0 / FPS, newton=PUSHED_NEWTON, newton_tolerance=PUSHED_TOLERANCE
    )


@dataclass(frozen=True, kw_only=True)
class StressScene:
    """One hard case.

    Attributes
    ----------
    cloth, edge
        The cloth, and the length of its edges [m].
    plan, seconds
        How it is run, and for how long [s].
    avatar, motion
        Obstacle (vertices, faces) and its motion, or None.
    pin_motion
        Motion of the points that pinned nodes follow, or None.
    expected
        "valid" or "message".
    limit
        CPU time that it may take [s].
    shows_avatar
        Whether its picture shows the obstacle: not one that the cloth is inside of.
    """

    cloth: Cloth
    edge: float
    plan: FilmPlan
    seconds: float
    avatar: tuple[Float, Int] | None = None
    motion: VertexMotion | None = None
    pin_motion: VertexMotion | None = None
    expected: str = "valid"
    limit: float = 120.0
    shows_avatar: bool = True
