"""The avatar over time, written frame by frame into an .npz file as its modifiers and bones move it."""

from pathlib import Path
from typing import Any
from zipfile import ZIP_STORED, ZipFile

import numpy as np

from toile.blender_addon.garment_snapshot import evaluated
from toile.blender_addon.mesh_arrays import positions, triangles
from toile.blender_addon.problem import Problem
from toile.blender_addon.space import moved, to_engine
from toile.dress.writers.ply import ply_bytes
from toile.geometry.arrays import Float, Int

STILL, MOVING = "avatar.ply", "avatar.npz"


class AvatarSnapshot:
    """All avatar objects as one surface; quads that bend keep the triangles of the first frame."""

    def __init__(self, objects: list[Any], scene: Any, depsgraph: Any) -> None:
        self._objects, self._scene = objects, scene
        self._counts: list[int] = []
        parts: list[Int] = []
        for obj in objects:
            with evaluated(obj, depsgraph) as mesh:
                mirrored = obj.evaluated_get(depsgraph).matrix_world.is_negative
                faces = triangles(mesh)[0]
                parts.append((faces[:, ::-1] if mirrored else faces) + np.int32(sum(self._counts)))
                self._counts.append(len(mesh.vertices))
        self.faces: Int = np.concatenate(parts)
        if not len(self.faces):
            raise Problem(f"'{objects[0].name}' has no faces: an avatar is a closed surface")

    def see(self, depsgraph: Any) -> Float:
        """Vertices in the present frame [m], Y up, shape (v, 3)."""
        parts = []
        for obj, count in zip(self._objects, self._counts, strict=True):
            with evaluated(obj, depsgraph) as mesh:
                if len(mesh.vertices) != count:
                    frame = self._scene.frame_current
                    raise Problem(f"'{obj.name}' has another number of vertices in frame {frame}; an avatar "
                                  "keeps its mesh while it moves")  # fmt: skip
                matrix = to_engine(obj.evaluated_get(depsgraph).matrix_world, self._scene)
                parts.append(moved(matrix, positions(mesh)))
        return np.concatenate(parts)


def write_still(folder: Path, vertices: Float, faces: Int) -> None:
    """Write an avatar that does not move."""
    (folder / STILL).write_bytes(ply_bytes(vertices, faces))


class MotionWriter:
    """An .npz of vertices over time, of which each frame is written when it comes."""

    def __init__(self, folder: Path, frames: int, vertices: int) -> None:
        self._zip = ZipFile(folder / MOVING, "w", ZIP_STORED)
        self._stream = self._zip.open("vertices.npy", "w", force_zip64=True)
        header = {"descr": "<f4", "fortran_order": False, "shape": (frames, vertices, 3)}
        np.lib.format.write_array_header_1_0(self._stream, header)

    def add(self, vertices: Float) -> None:
        """Append a frame, shape (v, 3)."""
        self._stream.write(np.ascontiguousarray(vertices, "<f4").tobytes())

    def close(self, faces: Int, fps: float) -> None:
        """Complete the file."""
        self._stream.close()
        for name, array in (("faces", faces), ("fps", np.float64(fps))):
            with self._zip.open(f"{name}.npy", "w") as stream:
                np.lib.format.write_array(stream, np.asarray(array))
        self._zip.close()
