"""Coulomb friction of yarns that slide through crossings.

With e the length of yarn that has passed the crossing since it last slid, k_f a stiff spring and N the force
by which the yarns press on each other:

    E = k_f e^2/2 where k_f |e| <= mu N,  mu N |e| - (mu N)^2/(2 k_f) beyond
"""

import numpy as np

from toile.geometry.arrays import Float

TINY = 1e-30
"""No length at all [m]."""


def friction_energy(passed: Float, most: Float, stiffness: float) -> tuple[Float, Float, Float, Float]:
    """Return energies [J], forces [N] that hold lengths of yarn [m] back, their tangents and secants [N/m].

    most: mu N [N]; all of shape (n, 2), warp and weft of every crossing. The tangent is zero where yarn
    slides, so that Newton's method throws it far at first; with the secant it only creeps in the end.
    """
    sticks = stiffness * np.abs(passed) <= most
    energy = np.where(
        sticks, 0.5 * stiffness * passed**2, most * np.abs(passed) - most**2 / (2.0 * stiffness)
    )
    secant = most / np.maximum(np.abs(passed), most / stiffness + TINY)
    return (
        energy, np.clip(stiffness * passed, -most, most), np.where(sticks, stiffness, 0.0),
        np.where(sticks, stiffness, secant),
    )  # fmt: skip


def follow(anchors: Float, slides: Float, most: Float, stiffness: float) -> Float:
    """Return the anchors from which sliding yarn starts next, shape (n, 2)."""
    return slides - np.clip(slides - anchors, -most / stiffness, most / stiffness)
