"""Strain and tension of cloth per face."""

from dataclasses import dataclass

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.membrane import Membrane
from toile.engine.step.cloth_forces import cloth_forces
from toile.engine.step.options import StepOptions
from toile.geometry.arrays import Float


@dataclass(frozen=True, kw_only=True)
class ClothState:
    """Strain and tension of every face.

    Attributes
    ----------
    strain
        Along warp and weft, 1 is twice as long, shape (t, 2).
    shear
        Tangent of the angle by which warp and weft have left the right one, positive where it closed, (t,).
    along
        Tension along warp and weft, per width of the cloth as it was cut [N/m], shape (t, 2).
    tension
        Largest tension in any direction, per width as it is now [N/m], shape (t,).
    area
        Area as it is now [m^2], shape (t,).
    """

    strain: Float
    shear: Float
    along: Float
    tension: Float
    area: Float


def cloth_state(cloth: Cloth) -> ClothState:
    """Return strain and tension of a cloth, by the membrane force that holds it."""
    forces = cloth_forces(cloth, StepOptions())
    membrane = next(force for force in forces if isinstance(force, Membrane))
    threads = membrane.gradient(cloth.positions)
    warp, weft = threads[..., 0], threads[..., 1]
    lengths = np.linalg.norm(threads, axis=1)
    normal = np.cross(warp, weft)
    # Area as it is over the area that was cut.
    grown = np.linalg.norm(normal, axis=1)
    stress = _first_piola(membrane, cloth)
    safe = np.maximum(lengths, 1e-300)
    return ClothState(
        strain=lengths - 1.0,
        shear=np.einsum("ti,ti->t", warp, weft) / np.maximum(grown, 1e-300),
        along=np.einsum("tik,tik->tk", stress, threads) / safe,
        tension=_largest(stress, threads, grown),
        area=grown * cloth.rest_area,
    )


def _first_piola(membrane: Membrane, cloth: Cloth) -> Float:
    """Return force per width that was cut, across warp and weft [N/m], shape (t, 3, 2).

    With the gradients g_c at the corners X_c of a face of area A it is sum g_c X_c / A, whatever the law.
    """
    membrane.evaluate_gradient(cloth.positions)
    area = np.maximum(membrane.shape[:, 0], 1e-300)
    forces = np.einsum("tci,tck->tik", membrane.element_gradient, cloth.rest_corners)
    return np.asarray(forces / area[:, None, None])


def _largest(stress: Float, threads: Float, grown: Float) -> Float:
    """Return the largest principal value of the Cauchy stress P F^T / J in the plane of faces [N/m], (t,)."""
    first = threads[..., 0] / np.maximum(np.linalg.norm(threads[..., 0], axis=1), 1e-300)[:, None]
    second = threads[..., 1] - np.einsum("ti,ti->t", threads[..., 1], first)[:, None] * first
    second /= np.maximum(np.linalg.norm(second, axis=1), 1e-300)[:, None]
    axes = np.stack([first, second], axis=1)
    cauchy = np.einsum("tik,tjk->tij", stress, threads) / np.maximum(grown, 1e-300)[:, None, None]
    plane = np.einsum("tai,tij,tbj->tab", axes, cauchy, axes)
    plane = 0.5 * (plane + plane.transpose(0, 2, 1))
    return np.asarray(np.linalg.eigvalsh(plane)[:, 1])
