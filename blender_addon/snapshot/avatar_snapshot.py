"""The avatar as its modifiers and bones move it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from toile.blender_addon.problem import Problem
from toile.blender_addon.snapshot.cast import AvatarPart, placed
from toile.blender_addon.snapshot.garment_snapshot import evaluated
from toile.blender_addon.snapshot.mesh_arrays import positions, triangles
from toile.blender_addon.snapshot.open_sheet import OpenSheets
from toile.blender_addon.snapshot.space import Space, moved
from toile.dressing.files.writers.ply import ply_bytes
from toile.geometry.arrays import Float, Int

STILL, MOVING = "avatar.ply", "avatar.npz"


class AvatarSnapshot:
    """All avatar objects as one surface; quads that bend keep the triangles of the first frame.

    `thickened` names the objects that are open sheets, and got a solid below them.
    """

    def __init__(self, parts: tuple[AvatarPart, ...], scene: Any, space: Space) -> None:
        self._parts, self._scene, self._space = parts, scene, space
        self._counts: list[int] = []
        self._sheets: list[OpenSheets] = []
        self.faces: Int = np.empty((0, 3), np.int32)
        self.thickened: list[str] = []
        self.name = "the avatar"

    def read(self, depsgraph: Any) -> Iterator[None]:
        """Take over the faces, an object in every step."""
        seen = []
        for obj, matrix in placed(self._parts, depsgraph):
            with evaluated(obj, depsgraph) as mesh:
                faces = triangles(mesh)[0]
                points = moved(self._space.of(matrix), positions(mesh))
                is_closed = 2 * len(mesh.edges) == len(mesh.loops)
            self._counts.append(len(points))
            if np.linalg.det(matrix[:3, :3]) < 0.0:
                faces = faces[:, ::-1]
            sheets = OpenSheets(points, faces, is_closed=is_closed)
            if sheets.is_folded(points):
                raise Problem(
                    f"'{obj.name}' is an open surface that folds over or whose faces look to both sides: let "
                    "its normals point to the cloth's side, or give it a Solidify modifier"
                )
            seen.append((obj, points, sheets))
            self._sheets.append(sheets)
            yield
        bodies = [points for _, points, sheets in seen if not sheets]
        for obj, points, sheets in seen:
            if sheets:
                # Without a body, a sheet looks up.
                above = points.mean(axis=0) + np.array((0.0, 1.0, 0.0))
                sheets.turn_to(points, np.concatenate(bodies).mean(axis=0) if bodies else above)
                self.thickened.append(obj.name)
        first, pieces = 0, [self.faces]
        for _, points, sheets in seen:
            pieces.append(sheets.faces + np.int32(first))
            first += len(sheets.with_below(points))
        self.faces = np.concatenate(pieces)
        if not len(self.faces):
            raise Problem(f"'{self._parts[0].obj.name}' has no faces: a solid is a closed surface")

    def see(self, depsgraph: Any) -> Float:
        """Vertices in the present frame [m], Y up, shape (v, 3)."""
        found = []
        for (obj, matrix), count, sheets in zip(
            placed(self._parts, depsgraph), self._counts, self._sheets, strict=True
        ):
            with evaluated(obj, depsgraph) as mesh:
                if len(mesh.vertices) != count:
                    frame = self._scene.frame_current
                    raise Problem(f"'{obj.name}' changes its number of vertices in frame {frame}; a solid "
                                  "keeps its mesh while it moves")  # fmt: skip
                found.append(sheets.with_below(moved(self._space.of(matrix), positions(mesh))))
        return np.concatenate(found)


def write_still(folder: Path, vertices: Float, faces: Int) -> None:
    """Write an avatar that does not move."""
    (folder / STILL).write_bytes(ply_bytes(vertices, faces))
