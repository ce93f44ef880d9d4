"""A garment object as the engine reads it: mesh above toile's modifier, pins, stitches, attributes."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from toile.blender_addon.problem import Problem
from toile.blender_addon.result import is_ours
from toile.blender_addon.snapshot import carriers, mesh_arrays
from toile.blender_addon.snapshot.painted import PaintedFields
from toile.blender_addon.snapshot.space import Space, moved
from toile.dressing.files.writers.npz_motion import MotionWriter
from toile.geometry.arrays import Float

FIXED = 0.999
"""Weight from which a pin does not give way, as in Blender's own cloth."""
AT_ONCE = 8000
"""Vertices whose groups are read in one step: Blender hands them out one by one."""
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

    def __init__(self, obj: Any, stem: str, space: Space, folder: Path, frames: int) -> None:
        self.obj, self.stem = obj, stem
        self._space, self._folder, self._frames = space, folder, frames
        self._to_local: list[Float] = []
        self._motion: MotionWriter | None = None

    def read(self, depsgraph: Any) -> Iterator[None]:
        """Take over mesh, groups and attributes, in steps that each take a moment."""
        settings, name = self.obj.toile, self.obj.name
        with evaluated(self.obj, depsgraph) as mesh:
            if not len(mesh.polygons):
                raise Problem(f"'{name}' has no faces: a garment is a surface")
            faces, loops, polygon = mesh_arrays.triangles(mesh)
            carried = mesh_arrays.attributes(mesh)
            chosen, self.left_behind = mesh_arrays.chosen(mesh), mesh_arrays.left_behind(mesh)
            loop_vertex = mesh_arrays.loop_vertices(mesh)
            self._local = mesh_arrays.positions(mesh)
            sewn = mesh_arrays.loose_edges(mesh)
        yield
        names = [group.name for group in self.obj.vertex_groups]
        weights = np.zeros((len(names), len(self._local)), np.float32)
        for start in range(0, len(self._local), AT_ONCE):
            with evaluated(self.obj, depsgraph) as mesh:
                mesh_arrays.add_group_weights(mesh, start, AT_ONCE, weights)
            yield
        groups = dict(zip(names, weights, strict=True))
        at_loops = [values for (domain, *_), values in carried.items() if domain == "CORNER"]
        corner, first = mesh_arrays.corners(loop_vertex, at_loops)
        self.arrays: dict[str, Any] = {
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
        self._pins = False
        if settings.pin_group:
            if settings.pin_group not in groups:
                raise Problem(f"'{name}' has no vertex group '{settings.pin_group}' for its pins")
            pins = groups[settings.pin_group]
            self._pins = bool(pins.any())
            self.arrays["pins"] = np.where(pins >= FIXED, np.float32(1.0), pins)
            self.arrays["pin_stiffness"] = settings.pin_stiffness
        if settings.use_sewing and len(sewn):
            self.arrays["stitches"] = sewn
        for group, weights in groups.items():
            if group.startswith(HELD):
                self.arrays[group] = np.flatnonzero(weights > 0.0)
        by_vertex = {
            name: values for (domain, kind, name), values in carried.items()
            if domain == "POINT" and kind in ("FLOAT", "BOOLEAN")
        }  # fmt: skip
        self._fields = PaintedFields(self.obj, by_vertex | groups)
        self.arrays |= self._fields.arrays
        carried |= {("POINT", "FLOAT", group): weights for group, weights in groups.items()}
        travelling, self.carriers = carriers.carried(carried, *chosen)
        self.carried: dict[str, Any] = {
            " ".join(key): values[first] if key[0] == "CORNER" else values
            for key, values in travelling.items()
        }
        self.carried["corner_vertex"] = loop_vertex[first]

    def pieces(self) -> list[str]:
        """Return the name of the material of every piece, as the engine numbers them; empty where none is."""
        slots = self.obj.material_slots
        used = np.unique(self.arrays.get("panel", 0)).tolist()
        return [slots[number].name if number < len(slots) else "" for number in used]

    def fields_toml(self, fps: float) -> list[str]:
        """Return the tables of its fields in a scene file."""
        return self._fields.toml(fps)

    def see(self, depsgraph: Any) -> None:
        """Note where object and pins are in the present frame, and the values of its fields."""
        self._fields.see()
        matrix = self._space.of(self.obj.evaluated_get(depsgraph).matrix_world)
        if abs(np.linalg.det(matrix)) < 1e-18:
            raise Problem(f"'{self.obj.name}' is scaled to nothing; give it a scale other than 0")
        self._to_local.append(np.asarray(np.linalg.inv(matrix), np.float64))
        local = self._local
        if len(self._to_local) == 1:
            start = moved(matrix, local).astype(np.float32)
            self.arrays["vertices"] = start.astype(np.float64)
            if self._pins and self._frames > 1:
                path = self._folder / f"{self.stem}.npz"
                self._motion = MotionWriter(path, "motion", self._frames, len(start))
        elif self._motion is not None:
            with evaluated(self.obj, depsgraph) as mesh:
                local = mesh_arrays.positions(mesh)
            if len(local) != len(self._local):
                name = self.obj.name
                raise Problem(f"'{name}' changes its number of vertices; its pins need a constant one")
        if self._motion is not None:
            self._motion.add(moved(matrix, local))

    def write(self, fps: float) -> None:
        """Write what the engine reads, and what its frames carry."""
        arrays, carried = self.arrays, dict(self.carried, to_local=np.stack(self._to_local))
        if self._motion is not None:
            self._motion.close(**arrays, fps=fps)
        else:
            np.savez(self._folder / f"{self.stem}.npz", **arrays)
        np.savez(self._folder / f"{self.stem}_carried.npz", **carried)
