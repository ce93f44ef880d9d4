"""Order of panels that hang from a curled edge: they start outside the panel they are sewn to.

A flared panel (a circle skirt, a peplum) has a curled waist edge. When a straighter edge opens it out, the
ends of the panel swing up and outward beside the seam. If they start between the body and the panel above,
they are trapped there, and the seam cannot close.
"""

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.geometry.arrays import Float, Int

CURLED = 1.05
"""Length of a seam over the distance of its ends from which a panel counts as flared."""
FACING = 0.7
"""Least share of a panel's normal towards front or back."""
BEYOND = 0.02
"""How far outside the upper panel the flared one starts [m]."""


def flared_outside(mesh: GarmentMesh, unit: float = 1.0) -> tuple[GarmentMesh, tuple[str, ...]]:
    """Move flared panels that lie behind the panel they hang from outside it; say which and how far.

    `unit` is how many metres a unit of length is.
    """
    if not mesh.flat or not len(mesh.stitches):
        return mesh, ()
    owner = np.zeros(len(mesh.positions), np.int32)
    owner[mesh.faces.ravel()] = np.repeat(mesh.panel, 3)
    facing = _facing(mesh)
    positions = mesh.positions.copy()
    moved: dict[int, float] = {}
    # From the top down: every tier clears the one above it where that has come to lie.
    seams = sorted(np.unique(mesh.seam), key=lambda seam: -_height(mesh, mesh.stitches[mesh.seam == seam]))
    for seam in seams:
        pairs = mesh.stitches[mesh.seam == seam]
        one, other = int(owner[pairs[0, 0]]), int(owner[pairs[0, 1]])
        if one == other:
            continue
        curls = [curl(mesh.uv[pairs[:, side]]) for side in (0, 1)]
        flared, above = (one, other) if curls[0] > curls[1] else (other, one)
        if max(curls) < CURLED or abs(facing[flared]) < FACING or facing[flared] * facing[above] <= 0.0:
            continue
        hanging, upper = np.flatnonzero(owner == flared), np.flatnonzero(owner == above)
        if not _overlap(positions[hanging], positions[upper]):
            continue
        side = np.sign(facing[flared])
        wanted = (side * positions[upper, 2]).max() + BEYOND - (side * positions[hanging, 2]).min()
        if wanted > 0.0:
            positions[hanging, 2] += side * wanted
            moved[flared] = moved.get(flared, 0.0) + float(wanted)
    notes = tuple(
        f"garment {mesh.name}: panel {mesh.panel_names[panel]} starts {100.0 * unit * distance:.0f} cm "
        "farther out, outside the panel it hangs from"
        for panel, distance in moved.items()
    )
    return (replace(mesh, positions=positions), notes) if moved else (mesh, ())


def _facing(mesh: GarmentMesh) -> Float:
    """Front (+) or back (-) part of every panel's unit normal, shape (p,)."""
    a, b, c = mesh.positions[mesh.faces].transpose(1, 0, 2)
    normal = np.zeros((len(mesh.panel_names), 3))
    np.add.at(normal, mesh.panel, np.cross(b - a, c - a))
    return np.asarray(normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-300))


def _height(mesh: GarmentMesh, pairs: Int) -> float:
    return float(mesh.positions[pairs.ravel(), 1].mean())


def curl(line: Float) -> float:
    """Length of a polyline, shape (k, 2), over the distance of its ends."""
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    return float(length / max(float(np.linalg.norm(line[-1] - line[0])), 1e-9))


def _overlap(one: Float, other: Float) -> bool:
    """Whether two panels cover each other seen from the front, beyond where their edges meet."""
    distance, _ = cKDTree(other[:, :2]).query(one[:, :2])
    neighbour, _ = cKDTree(other[:, :2]).query(other[:, :2], k=[2])
    return bool(np.mean(distance < np.median(neighbour)) > 0.02)
