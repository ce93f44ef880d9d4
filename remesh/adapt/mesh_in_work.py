"""A cloth mesh during a remeshing pass.

Nodes and material vertices are only added or marked as removed, so that their numbers stay valid during a
pass; faces keep their row while they live. `finish` closes the gaps.
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from numba import types

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import F64_2, F64_3, I32_1, I32_2, OUT_F64_3, kernel
from toile.remesh.adapt.transfer import Births, TransferMap, transfer_map
from toile.remesh.mesh.cloth_mesh import ClothMesh
from toile.remesh.mesh.mesh_edges import MeshEdges, build_edges, pair_keys
from toile.remesh.sizing.packed_tensor import packed
from toile.remesh.sizing.row_products import row_cross


@dataclass
class MeshInWork:
    """Arrays of `ClothMesh` plus bookkeeping.

    Attributes
    ----------
    tensors
        Metric of every material vertex [1/m^2], packed, shape (m, 6).
    normals
        Unit normal of every face in rest space, shape (t, 3).
    parent
        Face of the mesh at the start that every face comes from, shape (t,).
    node_alive, vertex_alive
        False for removed nodes and material vertices, shapes (n,) and (m,).
    births
        What was added, batch by batch.
    """

    rest: Float
    node: Int
    faces: Int
    frames: Float
    region: Int
    positions: Float
    kept: Bool
    pinned: Bool
    frozen_keys: npt.NDArray[np.int64]
    tensors: Float
    normals: Float
    parent: Int
    node_alive: Bool
    vertex_alive: Bool
    births: list[Births] = field(default_factory=list)
    _edges: MeshEdges | None = None

    @staticmethod
    def start(mesh: ClothMesh, tensors: Float) -> "MeshInWork":
        """Copy what may change of a mesh; `tensors` are per material vertex [1/m^2], shape (m, 3, 3)."""
        return MeshInWork(
            rest=mesh.rest,
            node=mesh.node,
            faces=mesh.faces.copy(),
            frames=mesh.frames.copy(),
            region=mesh.region.copy(),
            positions=mesh.positions,
            kept=mesh.kept,
            pinned=mesh.pinned,
            frozen_keys=np.sort(pair_keys(mesh.frozen_edges[:, 0], mesh.frozen_edges[:, 1])),
            tensors=packed(tensors),
            normals=row_cross(mesh.frames[..., 0], mesh.frames[..., 1]),
            parent=np.arange(len(mesh.faces), dtype=np.int32),
            node_alive=np.ones(len(mesh.positions), bool),
            vertex_alive=np.ones(len(mesh.rest), bool),
        )

    @property
    def face_nodes(self) -> Int:
        """Nodes of every face, shape (t, 3)."""
        return np.ascontiguousarray(self.node[self.faces])

    def rest_corners(self, faces: Int, like: Int) -> Float:
        """Rest shapes of faces (k, 3) in the planes of faces `like`, (warp, weft) [m], shape (k, 3, 2)."""
        corners = np.empty((len(faces), 3, 2))
        _lay_down(faces, like, self.rest, self.frames, corners)
        return corners

    @property
    def edges(self) -> MeshEdges:
        """The edges of the mesh as it is now."""
        if self._edges is None:
            self._edges = build_edges(
                self.faces, self.node, self.region, self.rest, self.normals, self.frozen_keys
            )
        return self._edges

    def forget_edges(self) -> None:
        """Note that faces changed in ways that `edges` has not followed."""
        self._edges = None

    def add_vertices(self, births: Births) -> None:
        """Add nodes and material vertices half-way between their parents."""
        a, b = births.node_parents.T
        self.positions = np.concatenate([self.positions, 0.5 * (self.positions[a] + self.positions[b])])
        self.pinned = np.concatenate([self.pinned, births.on_line & self.pinned[a] & self.pinned[b]])
        self.kept = np.concatenate([self.kept, np.zeros(len(a), bool)])
        self.node_alive = np.concatenate([self.node_alive, np.ones(len(a), bool)])
        a, b = births.vertex_parents.T
        self.rest = np.concatenate([self.rest, 0.5 * (self.rest[a] + self.rest[b])])
        self.tensors = np.concatenate([self.tensors, 0.5 * (self.tensors[a] + self.tensors[b])])
        self.node = np.concatenate([self.node, births.vertex_node])
        self.vertex_alive = np.concatenate([self.vertex_alive, np.ones(len(a), bool)])
        self.births.append(births)

    def add_faces(self, faces: Int, like: Int) -> None:
        """Append faces (k, 3) that lie within the faces `like`, shape (k,)."""
        self.faces = np.concatenate([self.faces, faces])
        self.frames = np.concatenate([self.frames, self.frames[like]])
        self.normals = np.concatenate([self.normals, self.normals[like]])
        self.region = np.concatenate([self.region, self.region[like]])
        self.parent = np.concatenate([self.parent, self.parent[like]])

    def keep_faces(self, kept: Bool) -> None:
        """Drop all other faces; `kept` has shape (t,)."""
        self.faces = self.faces[kept]
        self.frames = self.frames[kept]
        self.normals = self.normals[kept]
        self.region = self.region[kept]
        self.parent = self.parent[kept]

    def finish(self, mesh: ClothMesh) -> tuple[ClothMesh, TransferMap]:
        """Close the gaps; `mesh` is what the work started from."""
        transfer = transfer_map(
            self.births, len(mesh.positions), len(mesh.rest), self.node_alive, self.vertex_alive, self.parent
        )
        new_vertex = np.cumsum(self.vertex_alive, dtype=np.int32) - np.int32(1)
        new_node = np.cumsum(self.node_alive, dtype=np.int32) - np.int32(1)
        result = ClothMesh(
            rest=self.rest[self.vertex_alive],
            node=new_node[self.node[self.vertex_alive]],
            faces=new_vertex[self.faces],
            frames=self.frames,
            region=self.region,
            positions=self.positions[self.node_alive],
            kept=self.kept[self.node_alive],
            pinned=self.pinned[self.node_alive],
            frozen_edges=new_node[mesh.frozen_edges],
        )
        return result, transfer


@kernel(types.void(I32_2, I32_1, F64_2, F64_3, OUT_F64_3))
def _lay_down(faces, like, rest, frames, corners):  # type: ignore[no-untyped-def]
    """Fill corners (k, 3, 2) of faces in the planes of faces `like`, the first at the origin."""
    for row in range(len(faces)):
        first, t = faces[row, 0], like[row]
        for corner in range(3):
            vertex = faces[row, corner]
            for way in range(2):
                total = 0.0
                for axis in range(3):
                    total += (rest[vertex, axis] - rest[first, axis]) * frames[t, axis, way]
                corners[row, corner, way] = total
