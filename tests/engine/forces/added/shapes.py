"""Tubes and balloons of cloth, for tests of elastic and pressure."""

from dataclasses import replace

import numpy as np
import trimesh

from tests.engine.step.test_only_what_is_asked import SLACK
from toile.dressing.garment.mesh_garment import warp_directions
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.geometry.arrays import Float, Int
from toile.studies.scenes.flat_meshes import right_grid

SOFT = replace(SLACK, stretch_warp=500.0, stretch_weft=500.0, shear=100.0, compression=0.02)


def tube(girth: float, width: float, edge: float, radius: float, fabric: Fabric = SOFT) -> Cloth:
    """A band about the y axis, its warp around it, sewn to a ring; it starts as a circle of a radius [m]."""
    points, faces = right_grid(girth, width, edge)
    angle = 2.0 * np.pi * points[:, 0] / girth
    start = np.column_stack([radius * np.cos(angle), points[:, 1], -radius * np.sin(angle)])
    flat = flat_cloth(points, faces, start, fabric)
    first, last = (np.flatnonzero(np.abs(points[:, 0] - x) < 1e-9) for x in (0.0, girth))
    node = np.arange(len(points), dtype=np.int32)
    node[last] = first
    used, merged = np.unique(node, return_inverse=True)
    return replace(
        flat, node=merged.astype(np.int32), positions=start[used], velocities=np.zeros((len(used), 3)),
        pinned=np.zeros(len(used), bool),
    )  # fmt: skip


def ball(radius: float, fabric: Fabric = SOFT, subdivisions: int = 3) -> Cloth:
    """A closed ball whose rest shape is itself, its right side outside."""
    shape = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    points, faces = np.array(shape.vertices, np.float64), np.array(shape.faces, np.int32)
    corners = points[faces]
    warp = warp_directions(corners, None)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    weft = np.cross(normal, warp)
    sides = corners - corners[:, :1]
    rest = np.stack([np.einsum("tci,ti->tc", sides, axis) for axis in (warp, weft)], axis=2)
    return _closed(points, faces, np.ascontiguousarray(rest), fabric)


def _closed(points: Float, faces: Int, rest: Float, fabric: Fabric) -> Cloth:
    zeros, none = np.zeros(len(faces), np.int32), np.empty(0, np.int32)
    return Cloth(
        positions=points.copy(), velocities=np.zeros_like(points),
        node=np.arange(len(points), dtype=np.int32), faces=faces, rest_corners=rest, fabrics=(fabric,),
        fabric=zeros, garment=zeros, panel=zeros, uv=np.zeros((len(points), 2)),
        stitches=np.empty((0, 2), np.int32), seam=none, stitch_length=np.empty(0), held=none, waist=none,
        pinned=np.zeros(len(points), bool), rest_curved=np.ones(len(faces), bool),
        start_positions=points.copy(),
    )  # fmt: skip
