"""The quality presets preview, standard and accurate, in numbers."""

from dataclasses import dataclass

from toile.dressing.files.suggestion import unknown_name
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real
from toile.remesh.sizing.sizing import SizingOptions

COARSEST = 20.0
"""Longest edges of an adaptive mesh, in its shortest."""


@dataclass(frozen=True, kw_only=True)
class Quality:
    """Numbers behind one quality preset.

    Attributes
    ----------
    name
        The word the user types.
    edge_length
        Length of a triangle's edges in patterns, and the longest in mesh garments [m].
    max_frames
        Frames after which a drape that has not converged stops.
    refine_angle
        Turn of the surface per edge that adaptive remeshing aims at [rad].
    tolerance
        RMS node motion over an output frame below which a drape counts as converged [m].
    """

    name: str
    edge_length: float
    max_frames: int
    refine_angle: float
    tolerance: float

    def sizing(self, finest: float) -> SizingOptions:
        """Return the sizing of an adaptive mesh with shortest edges `finest` [m]."""
        return SizingOptions(
            size_min=finest,
            size_max=COARSEST * finest if is_real(finest) else finest,
            refine_angle=self.refine_angle,
        )


QUALITIES = {
    quality.name: quality
    for quality in (
        Quality(name="preview", edge_length=0.016, max_frames=80, refine_angle=0.6, tolerance=1e-3),
        Quality(name="standard", edge_length=0.010, max_frames=80, refine_angle=0.5, tolerance=4e-4),
        Quality(name="accurate", edge_length=0.007, max_frames=160, refine_angle=0.4, tolerance=2e-4),
    )
}


def quality_preset(name: str) -> Quality:
    """Return the preset of that name. Raises InputError with the nearest name."""
    if name not in QUALITIES:
        raise InputError(unknown_name("quality", name, QUALITIES), field="quality")
    return QUALITIES[name]
