"""Small nets that tests share: a poplin of 20 tex, 25 x 25 yarns per centimetre."""

import numpy as np

from toile.engine.swatch.net import Net, Strand, woven_net
from toile.geometry.arrays import Bool, Float

SPACING, WAVE = 4e-4, 1.67e-4
PLAIN = np.array([[True, False], [False, True]])
TWILL = np.array([np.roll([True, True, False, False], shift) for shift in range(4)])


def yarn(**changed: float) -> Strand:
    """Return the yarn of the poplin, or one with other numbers."""
    numbers = {
        "stiffness": 60.0, "bending": 1.8e-9, "linear_density": 2e-5, "width": 1e-4, "spacing": SPACING,
        "wave": WAVE, "set": 1.0,
    }  # fmt: skip
    return Strand(**{**numbers, **changed})


def net_of(ends: int, picks: int, strand: Strand, top: Bool = PLAIN) -> tuple[Net, Float]:
    """Return a rectangle of a weave at rest."""
    return woven_net(top, np.ones((ends, picks), bool), (strand, strand), 100.0, 1e6)
