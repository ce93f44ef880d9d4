"""Patch test: uniform strain is in equilibrium on any mesh, and rigid motions are free of force."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation

from toile.engine.forces.membrane import Membrane
from toile.geometry.arrays import Float, Int, as_positions
from toile.geometry.topology import triangle_topology
from toile.studies.scenes.flat_meshes import KINDS, mesh
from toile.studies.validation.validate_curvature import bending_of
from toile.studies.validation.validation_row import ValidationRow, absolute_row, relative_row

LENGTH, WIDTH, EDGE = 1.0, 0.8, 0.1
WARP, WEFT, SHEAR = 3000.0, 1200.0, 400.0
"""Stiffness [N/m]."""
STATES = {
    "stretched": np.array([[1.1, 0.0, 0.0], [0.0, 1.05, 0.0]]),
    "sheared": np.array([[1.02, 0.2, 0.0], [0.15, 1.03, 0.0]]),
    "pressed and turned": np.array([[1.1, 0.05, 0.2], [-0.03, 0.97, 0.1]]),
}
"""Where a metre of warp and of weft goes [m]."""
TURN, SHIFT = (1.0, -2.0, 0.5), 2.0
"""Rotation vector [rad] and translation [m] of the rigid motion."""
ROUNDING = 1e-12
"""Share of the stiffest spring's force at a strain of 1 that counts as nothing."""
ENERGY_BAR = 1e-9
"""Percent."""


def membrane_of(faces: Int, rest: Float) -> Membrane:
    """Return the membrane of faces (t, 3) with rest corners (t, 3, 2) [m]."""
    ones = np.ones(len(faces))
    return Membrane(faces, np.ascontiguousarray(rest), WARP * ones, WEFT * ones, SHEAR * ones)


def energy_density(state: Float) -> float:
    """Return the exact energy per area [J/m^2] of a state of STATES, shape (2, 3)."""
    u, v = state
    stretch = WARP * (np.linalg.norm(u) - 1.0) ** 2 + WEFT * (np.linalg.norm(v) - 1.0) ** 2
    return float(0.5 * (stretch + SHEAR * (u @ v) ** 2))


def forces_of(membrane: Membrane, x: Float) -> Float:
    """Return the membrane's gradient at nodes x [m], shape (n, 3) [N]."""
    membrane.evaluate(x)
    forces = np.zeros_like(x)
    np.add.at(forces, membrane.faces, membrane.element_gradient)
    return forces


def validate_patch() -> Iterator[ValidationRow]:
    """Strain and move sheets of three kinds of mesh."""
    for kind in KINDS:
        points, faces = mesh(kind, LENGTH, WIDTH, EDGE)
        membrane = membrane_of(faces, points[faces])
        inside = np.setdiff1d(np.arange(len(points)), triangle_topology(faces).border_edges)
        for name, state in STATES.items():
            x = as_positions(points @ state)
            energy = energy_density(state) * LENGTH * WIDTH
            yield relative_row(
                "patch", f"{kind}, {name}", "energy, J", membrane.energy(x), energy, ENERGY_BAR
            )
            force = float(np.abs(forces_of(membrane, x)[inside]).max()) / (WARP * EDGE)
            yield absolute_row("patch", f"{kind}, {name}", "force inside / k h", force, 0.0, ROUNDING)
        flat = np.column_stack((points, np.zeros(len(points))))
        moved = as_positions(Rotation.from_rotvec(TURN).apply(flat) + SHIFT)
        force = float(np.abs(forces_of(membrane, moved)).max()) / (WARP * EDGE)
        yield absolute_row("patch", f"{kind}, moved", "membrane force / k h", force, 0.0, ROUNDING)
        bending = bending_of(points, faces, (1.0, 2.0, 1.4))
        force = float(np.abs(bending.gradient(moved)).max() / np.abs(bending.stiffness.data).max())
        yield absolute_row("patch", f"{kind}, moved", "bending force / S, m", force, 0.0, ROUNDING)
