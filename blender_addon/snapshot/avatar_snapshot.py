"""The avatar as its modifiers and bones move it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from toile.blender_addon.problem import Problem
from toile.blender_addon.snapshot.garment_snapshot import evaluated
from toile.blender_addon.snapshot.mesh_arrays import positions, triangles
from toile.blender_addon.snapshot.space import moved, to_engine
from toile.dressing.files.writers.ply import ply_bytes
from toile.geometry.arrays import Float, Int

STILL, MOVING = "avatar.ply", "avatar.npz"


class AvatarSnapshot:
    """All avatar objects as one surface; quads that bend keep the triangles of the first frame."""

    def __init__(self, objects: list[Any], scene: Any) -> None:
        self._objects, self._scene = objects, scene
        self._counts: list[int] = []
        self.faces: Int = np.empty((0, 3), np.int32)

    def read(self, depsgraph: Any) -> Iterator[None]:
        """Take over the faces, an object in every step."""
        for obj in self._objects:
            with evaluated(obj, depsgraph) as mesh:
                faces = triangles(mesh)[0] + np.int32(sum(self._counts))
                self._counts.append(len(mesh.vertices))
            if obj.evaluated_get(depsgraph).matrix_world.is_negative:
                faces = faces[:, ::-1]
            self.faces = np.concatenate([self.faces, faces])
            yield
        if not len(self.faces):
            raise Problem(f"'{self._objects[0].name}' has no faces: an avatar is a closed surface")

    def see(self, depsgraph: Any) -> Float:
        """Vertices in the present frame [m], Y up, shape (v, 3)."""
        parts = []
        for obj, count in zip(self._objects, self._counts, strict=True):
            with evaluated(obj, depsgraph) as mesh:
                if len(mesh.vertices) != count:
                    frame = self._scene.frame_current
                    raise Problem(f"'{obj.name}' changes its number of vertices in frame {frame}; an avatar "
                                  "keeps its mesh while it moves")  # fmt: skip
                matrix = to_engine(obj.evaluated_get(depsgraph).matrix_world, self._scene)
                parts.append(moved(matrix, positions(mesh)))
        return np.concatenate(parts)


def write_still(folder: Path, vertices: Float, faces: Int) -> None:
    """Write an avatar that does not move."""
    (folder / STILL).write_bytes(ply_bytes(vertices, faces))
