"""The eight steps of the lecture: what stands on the left and on the right, and what may be changed."""

from dataclasses import dataclass

from toile.dressing.garment.fabrics import fabric
from toile.studies.lecture.setup import Setup

DENIM = "denim-12oz"
POPLIN = "cotton-poplin"


@dataclass(frozen=True, kw_only=True)
class Lesson:
    """One step of the lecture.

    Attributes
    ----------
    name
        What the words of the page call it.
    panes
        Left and right.
    controls
        Fields of a `Setup` that the page offers for both panes at once.
    own
        Fields that it offers for each pane.
    curves
        What is drawn as it runs: "energy", "error" or both.
    """

    name: str
    panes: tuple[Setup, Setup]
    controls: tuple[str, ...] = ("stiffness", "damping")
    own: tuple[str, ...] = ()
    curves: tuple[str, ...] = ("energy",)


STEPS = (
    Lesson(
        name="springs",
        panes=(
            Setup(springs="structural", cells=8, pins="corners"), Setup(cells=8, pins="corners")
        ),
        controls=("stiffness",), own=("springs",),
    ),
    Lesson(
        name="forces",
        panes=(Setup(damping=0.0, method="bdf2"), Setup(damping=0.3, method="bdf2")),
        controls=("gravity", "stiffness"), own=("damping",),
    ),
    Lesson(
        name="wind",
        panes=(Setup(wind=4.0), Setup(wind=4.0, gusts=0.4)),
        controls=("wind", "stiffness"), own=("gusts",),
    ),
    Lesson(
        name="explicit",
        panes=(
            Setup(method="explicit", damping=0.2, step=0.0005, stiffness=50.0),
            Setup(method="explicit", damping=0.2, step=0.006, stiffness=50.0),
        ),
        own=("step",), curves=("energy", "error"),
    ),
    Lesson(
        name="implicit",
        panes=(Setup(method="symplectic", step=0.0025), Setup(method="implicit", step=1.0 / 60.0)),
        own=("method", "step"), curves=("energy", "error"),
    ),
    Lesson(
        name="triangles",
        panes=(Setup(model="springs", step=1.0 / 120.0), Setup(model="triangles", step=1.0 / 120.0)),
        controls=("stiffness", "damping", "wind"), own=("model", "cells"), curves=("energy", "error"),
    ),
    Lesson(
        name="remeshing",
        panes=(
            Setup(model="triangles", cells=10, ball=True, pins="none", fabric=fabric(POPLIN)),
            Setup(model="adaptive", cells=10, ball=True, pins="none", fabric=fabric(POPLIN)),
        ),
        controls=(), own=("cells",), curves=(),
    ),
    Lesson(
        name="yarns",
        panes=(
            Setup(model="triangles", cells=16, ball=True, pins="none", fabric=fabric(POPLIN)),
            Setup(model="triangles", cells=16, ball=True, pins="none", fabric=fabric(DENIM)),
        ),
        controls=(), curves=(),
    ),
)  # fmt: skip
"""The lecture."""

COMPARE = Lesson(
    name="compare",
    panes=(Setup(method="symplectic", step=0.0025), Setup(model="triangles", method="implicit")),
    controls=("stiffness", "damping", "wind", "gusts", "gravity", "pins"),
    own=("model", "method", "step", "cells"), curves=("energy", "error"),
)  # fmt: skip
"""The page that has two cloths side by side and nothing else."""
