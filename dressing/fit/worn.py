"""Garments as they are worn: what fit is read off."""

from dataclasses import dataclass

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.measurements import Measurements
from toile.dressing.body.place import Place
from toile.engine.cloth.cloth import Cloth
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float, Int


@dataclass(frozen=True, kw_only=True)
class WornGarment:
    """Names of a garment: its own, that of its fabric, and those of its panels."""

    name: str
    fabric: str
    panels: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Worn:
    """Garments on a body, in the body's own frame.

    Attributes
    ----------
    cloth
        All garments together.
    anchors
        Where friction holds the nodes [m], shape (n, 3), or None.
    step
        How contact was computed.
    vertices, faces
        The body [m], shapes (v, 3) and (s, 3).
    measured
        Its measurements, or None.
    avatar
        The body in the room of its file.
    place
        Where its own frame is there.
    garments
        In the order of `cloth.garment`.
    """

    cloth: Cloth
    anchors: Float | None
    step: StepOptions
    vertices: Float
    faces: Int
    measured: Measurements | None
    avatar: Avatar
    place: Place
    garments: tuple[WornGarment, ...]
