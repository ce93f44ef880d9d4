"""A garment object as the engine reads it: mesh before toile's modifier, pins, stitches, attributes."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from toile.blender_addon.mesh_arrays import (
    attributes,
    corners,
    loose_edges,
    positions,
    triangles,
    vertex_groups,
)
from toile.blender_addon.problem import Problem
from toile.blender_addon.result import is_ours
from toile.blender_addon.space import moved, to_engine
from toile.geometry.arrays import Float

PINNED = 0.5
"""Weight from which a vertex is pinned."""
HELD = "held_"
"""Begins the names of vertex groups of labelled edges, such as waistbands."""


@contextmanager
def fed_by_modifiers_above(garments: list[Any]) -> Iterator[None]:
    """Switch off toile's modifier and all below it, for a while."""
    off = []
    for garment in garments:
        ours = next((index for index, modifier in enumerate(garment.modifiers) if is_ours(modifier)), None)
        if ours is not None:
            off += [modifier for modifier in list(garment.modifiers)[ours:] if modifier.show_viewport]
    for modifier in off:
        modifier.show_viewport = False
    try:
        yield
    finally:
        for modifier in off:
            modifier.show_viewport = True


@contextmanager
def evaluated(obj: Any, depsgraph: Any) -> Iterator[Any]:
    """Give an object's mesh as its modifiers make it."""
    holder = obj.evaluated_get(depsgraph)
    mesh = holder.to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph)
    try:
        yield mesh
    finally:
        holder.to_mesh_clear()


class GarmentSnapshot:
    """One garment: seen whole in the first frame, then only where its pins go and how the object moves."""

    def __init__(self, obj: Any, stem: str, scene: Any, depsgraph: Any) -> None:
        self.obj, self.stem = obj, stem
        self._scene = scene
        with evaluated(obj, depsgraph) as mesh:
            self._read(mesh)
        self._to_local: list[Float] = []
        self._motion: list[npt.NDArray[np.float32]] = []

    def _read(self, mesh: Any) -> None:
        """Take over mesh, groups and attributes."""
        settings, name = self.obj.toile, self.obj.name
        if not len(mesh.polygons):
            raise Problem(f"'{name}' has no faces: a garment is a surface")
        faces, loops, polygon = triangles(mesh)
        carried = attributes(mesh)
        groups = vertex_groups(self.obj, mesh)
        loop_vertex = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", loop_vertex)
        at_loops = [values for (domain, *_), values in carried.items() if domain == "CORNER"]
        corner, first = corners(loop_vertex, at_loops)
        self._local = positions(mesh)
        self.arrays: dict[str, npt.NDArray[Any]] = {
            "faces": faces, "uv": np.zeros((len(first), 2)), "uv_faces": corner[loops], "polygon": polygon
        }  # fmt: skip
        material = carried.get(("FACE", "INT", "material_index"))
        if material is not None:
            self.arrays["panel"] = material[polygon]
        if settings.warp_map:
            uv = carried.get(("CORNER", "FLOAT2", settings.warp_map))
            if uv is None:
                raise Problem(f"'{name}' has no UV map '{settings.warp_map}' for its warp; choose another")
            self.arrays["uv"] = uv[first].astype(np.float64)
        self._pins = np.zeros(len(mesh.vertices), bool)
        if settings.pin_group:
            if settings.pin_group not in groups:
                raise Problem(f"'{name}' has no vertex group '{settings.pin_group}' for its pins")
            self._pins = groups[settings.pin_group] >= PINNED
            self.arrays["pins"] = self._pins
        if settings.use_sewing and len(stitches := loose_edges(mesh)):
            self.arrays["stitches"] = stitches
        for group, weights in groups.items():
            if group.startswith(HELD):
                self.arrays[group] = np.flatnonzero(weights > 0.0)
        carried |= {("POINT", "FLOAT", group): weights for group, weights in groups.items()}
        self.carried = {
            " ".join(key): values[first] if key[0] == "CORNER" else values for key, values in carried.items()
        }
        self.carried["corner_vertex"] = loop_vertex[first]

    def see(self, depsgraph: Any) -> None:
        """Note where object and pins are in the present frame."""
        holder = self.obj.evaluated_get(depsgraph)
        matrix = to_engine(holder.matrix_world, self._scene)
        if abs(np.linalg.det(matrix)) < 1e-18:
            raise Problem(f"'{self.obj.name}' is scaled to nothing; give it a scale other than 0")
        self._to_local.append(np.asarray(np.linalg.inv(matrix), np.float64))
        local = self._local
        if self._pins.any() and self._motion:
            with evaluated(self.obj, depsgraph) as mesh:
                local = positions(mesh)
            if len(local) != len(self._local):
                raise Problem(
                    f"'{self.obj.name}' changes its number of vertices; its pins need a constant one"
                )
        self._motion.append(moved(matrix, local).astype(np.float32))
        if not self._pins.any():
            del self._motion[1:]

    def write(self, folder: Path, fps: float) -> None:
        """Write what the engine reads, and what its frames carry."""
        arrays: dict[str, Any] = dict(self.arrays, vertices=self._motion[0].astype(np.float64))
        if len(self._motion) > 1:
            arrays |= {"motion": np.stack(self._motion), "fps": np.float64(fps)}
        np.savez(folder / f"{self.stem}.npz", **arrays)
        carried: dict[str, Any] = dict(self.carried, to_local=np.stack(self._to_local))
        np.savez(folder / f"{self.stem}_carried.npz", **carried)
