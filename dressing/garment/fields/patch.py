"""Patches: panels that lie on another panel, sewn to it along some of their edges, such as pockets."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.fields.closure_points import run_line
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.engine.cloth.fields.fastenings import Fastening
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, shown
from toile.geometry.normals import area_normals

SPACING = 0.008
"""Distance of the points at which a patch is sewn on [m], at most."""
APART = 0.0015
"""Distance of a patch from what it is sewn to [m]: contact wants 1 mm."""
STIFFNESS, MOST = 3e5, 1e4
"""Of the seam, per length: stiffness [N/m^2] and largest force [N/m]."""
AHEAD = 0.012
"""How far outside of what it is sewn to a patch starts [m]."""


@dataclass(frozen=True, kw_only=True)
class Patch:
    """A panel on the right side of another, sewn to it along a run of its edges and open elsewhere.

    Attributes
    ----------
    run
        Its edges that are sewn, of one panel, in a row: "pocket.3 + pocket.0 + pocket.1".
    onto
        Name of the panel that it lies on.
    at
        Where the origin of its own coordinates lies in those of that panel [m].
    turn
        By how much it is turned there, counter-clockwise seen from the right side [degrees].

    Raises InputError naming the field that is at fault.
    """

    run: str
    onto: str
    at: tuple[float, float]
    turn: float = 0.0

    def __post_init__(self) -> None:
        """Check every field."""
        for name in ("run", "onto"):
            if not isinstance(getattr(self, name), str) or not getattr(self, name):
                raise InputError(f"patch: {name} must be a text", field=name)
        at = self.at
        if not isinstance(at, list | tuple) or len(at) != 2 or not all(map(is_real, at)):
            raise InputError(f"patch: at must be two numbers [m], got {shown(at)}", field="at")
        if not is_real(self.turn):
            raise InputError(f"patch: turn must be a number of degrees, got {shown(self.turn)}", field="turn")


class _Lie(NamedTuple):
    """How the coordinates of a patch lie in those of the panel beneath: mirrored, turned, moved."""

    mirror: Float
    turn: Float
    at: Float

    def of(self, points: Float) -> Float:
        """Return points of the patch in the coordinates of the panel [m], shape (n, 2)."""
        return np.asarray((points * self.mirror) @ self.turn.T + self.at)


def patched(mesh: GarmentMesh, patches: tuple[Patch, ...]) -> GarmentMesh:
    """Return a mesh with patches in front of what they are sewn to, in their order.

    Raises InputError if a patch or what it lies on is not there, or if it reaches beyond it.
    """
    positions, fastenings = mesh.positions.copy(), list(mesh.fastenings)
    for patch in patches:
        if patch.onto not in mesh.panel_names:
            raise InputError(f"patch: {unknown_name('panel', patch.onto, mesh.panel_names)}", field="onto")
        line = run_line(patch.run, mesh, "run")
        onto = mesh.panel_names.index(patch.onto)
        if onto == line.panel:
            raise InputError(f"patch: '{patch.run}' is on the panel that it lies on", field="onto")
        own, base = (mesh.faces[mesh.panel == panel] for panel in (line.panel, onto))
        mirror = np.array([np.sign(_area(mesh, own) * _area(mesh, base)), 1.0])
        angle = np.radians(patch.turn) * np.sign(_area(mesh, base))
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        lie = _Lie(mirror, turn, np.array(patch.at))
        count = max(int(np.ceil(line.length / SPACING)), 2) + 1
        over = line.at(np.linspace(0.0, 1.0, count), 0.0)
        _check_within(lie.of(over), mesh.uv[base], patch)
        fastenings.append(
            Fastening(
                over=(0, line.panel), under=(0, onto), over_points=np.pad(over, ((0, 0), (0, 1))),
                under_points=np.pad(lie.of(over), ((0, 0), (0, 1))), side=1, distance=APART,
                stiffness=np.full(count, STIFFNESS * line.length / count),
                most=np.full(count, MOST * line.length / count), closed=1.0,
            )
        )  # fmt: skip
        vertices, under = np.unique(own), np.unique(base)
        points = lie.of(mesh.uv[vertices])
        positions[vertices] = _ahead(mesh.uv[under], positions[under], positions[base], points)
    return replace(mesh, positions=positions, fastenings=tuple(fastenings))


def _ahead(uv: Float, places: Float, corners: Float, points: Float) -> Float:
    """Return where points in the coordinates of a flat panel lie in front of its right side [m].

    Its vertices are at `uv` in its coordinates, (n, 2), and at `places`, (n, 3); its faces have `corners`,
    (t, 3, 3).
    """
    columns = np.column_stack([uv, np.ones(len(uv))])
    affine, *_ = np.linalg.lstsq(columns, places, rcond=None)
    normal = area_normals(corners).sum(axis=0)
    there = np.column_stack([points, np.ones(len(points))]) @ affine
    return np.asarray(there + AHEAD * normal / np.linalg.norm(normal))


def _area(mesh: GarmentMesh, faces: Int) -> float:
    """Signed area of faces in the panel's own coordinates [m^2]."""
    sides = mesh.uv[faces[:, 1:]] - mesh.uv[faces[:, :1]]
    return float(np.linalg.det(sides).sum())


def _check_within(points: Float, corners: Float, patch: Patch) -> None:
    """Raise InputError unless points (k, 2) lie in triangles (t, 3, 2)."""
    a, sides = corners[:, 0], np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
    shares = np.linalg.solve(sides[None], (points[:, None] - a)[..., None])[..., 0]
    least = np.minimum(shares.min(axis=2), 1.0 - shares.sum(axis=2)).max(axis=1)
    if (least < -1e-6).any():
        x, y = points[int(least.argmin())].tolist()
        raise InputError(
            f"patch: it reaches beyond panel '{patch.onto}', at ({x:.3f}, {y:.3f}) m of it; move it by at",
            field="at",
        )
