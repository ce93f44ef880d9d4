"""Attributes of Blender's meshes, transferred to the triangles of the engine."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from toile.blender_addon.engine_side.usd_frame import Primvar
from toile.blender_addon.snapshot.space import moved
from toile.dressing.run.result import DressedGarment
from toile.engine.cloth.origin import Origin
from toile.geometry.arrays import Float, Int

SMOOTH = ("FLOAT", "FLOAT2", "FLOAT_VECTOR", "FLOAT_COLOR")
"""Types of attributes that are interpolated; others come from the nearest vertex."""


class Carried:
    """Attributes of one garment object, and how its frames return into the object's own space.

    The file holds `corner_vertex` (p,), the vertex of every corner; `to_local` (k, 4, 4), from the engine's
    space at every frame; and arrays named "DOMAIN TYPE NAME", a row per vertex, corner or polygon.
    """

    def __init__(self, path: Path) -> None:
        with np.load(path, allow_pickle=False) as data:
            held = {name: data[name] for name in data.files}
        self._to_local = held.pop("to_local")
        self.corner_vertex: Int = held.pop("corner_vertex")
        self._attributes = [(*name.split(" ", 2), values) for name, values in held.items()]

    def local(self, points: Float, frame: int) -> Float:
        """Points [m], Y up, shape (n, 3), in the space of the object at a frame."""
        return moved(self._to_local[min(frame, len(self._to_local) - 1)], points)

    def local_vectors(self, vectors: Float, frame: int) -> Float:
        """Vectors such as velocities, shape (n, 3), in the space of the object at a frame."""
        matrix = self._to_local[min(frame, len(self._to_local) - 1)]
        return np.asarray(vectors @ matrix[:3, :3].T)

    def primvars(self, garment: DressedGarment) -> list[Primvar]:
        """Return all attributes on the garment's present mesh."""
        origin = garment.origin
        assert origin is not None
        some_vertex = np.zeros(len(garment.positions), np.int32)
        some_vertex[garment.faces] = garment.uv_faces
        nearest = origin.nearest()
        found = []
        for domain, kind, name, values in self._attributes:
            if domain == "FACE":
                found.append(Primvar(name, domain, kind, values[origin.face]))
                continue
            corners = values[self.corner_vertex] if domain == "POINT" else values
            own = _at(origin, nearest, corners, kind)
            elements = some_vertex if domain == "POINT" else garment.uv_faces.ravel()
            found.append(Primvar(name, domain, kind, own[elements]))
        return found


def _at(origin: Origin, nearest: Int, corners: npt.NDArray[Any], kind: str) -> npt.NDArray[Any]:
    """Return values of corners (p, ...) at material vertices (m, ...)."""
    return origin.at_vertices(corners.astype(np.float64)) if kind in SMOOTH else corners[nearest]
