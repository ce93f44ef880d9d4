"""Bending of fabric: quadratic, isotropic on any mesh, orthotropic in the fabric's directions.

Energy per rest area, for (nearly) isometric motion: 1/2 (D11 k_uu^2 + D22 k_vv^2 + 2 D12 k_uu k_vv + 4 D66
k_uv^2), where products of curvatures stand for dot products of the second derivatives of the position with
respect to the rest coordinates (u warp, v weft). On an isometric surface x_,ij is the curvature times the
normal, so this is the plate energy; and it is quadratic in the node positions with one scalar matrix for x, y
and z, constant until the mesh changes. `toile.geometry.patch` gives the second derivatives and says why they
converge.
"""

import numpy as np
import scipy.sparse as sp

from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.force import StepState
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.patch import bending_patches
from toile.geometry.topology import Topology, triangle_topology

SHARPEST = 1.0
"""Turn of a curved rest shape across a face, about, from which it is a crease [rad]."""


def bending_tensor(warp: Float, weft: Float, bias: Float, poisson: float = 0.0) -> Float:
    """Return rigidity tensors [N m] on (x_uu, x_vv, x_uv), shape (t, 3, 3), symmetric positive definite.

    `warp`, `weft`, `bias` (t,) are the rigidities when bent along warp, along weft and along the diagonal;
    the last fixes the twist rigidity by D45 = (D11 + D22 + 2 D12 + 4 D66) / 4 with D12 = poisson sqrt(D11
    D22). Where the bias rigidity is too small for that, 4 D66 is held at 2 % of D11 + D22, so that twist is
    resisted. Woven cloth bends along one thread almost without the other: poisson 0.
    """
    coupling = poisson * np.sqrt(warp * weft)
    tensor = np.zeros((len(warp), 3, 3))
    tensor[:, 0, 0], tensor[:, 1, 1] = warp, weft
    tensor[:, 0, 1] = tensor[:, 1, 0] = coupling
    tensor[:, 2, 2] = np.maximum(4.0 * bias - warp - weft - 2.0 * coupling, 0.02 * (warp + weft))
    return tensor


def face_frames(x: Float, faces: Int) -> Float:
    """Return orthonormal frames of faces at x, columns (first edge, in-plane, normal), shape (t, 3, 3)."""
    first = x[faces[:, 1]] - x[faces[:, 0]]
    normal = np.cross(first, x[faces[:, 2]] - x[faces[:, 0]])
    first = first / np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return np.stack((first, np.cross(normal, first), normal), axis=2)


def _crease_share(rest: Float, corners: Float) -> Float:
    """Share of its rigidity that each face keeps, shape (t,), for rest derivatives (t, 3, 3) [1/m].

    A rest shape that turns by more than SHARPEST across a face is a crease the mesh does not resolve: its
    derivatives say little, and the moments they ask for would tear at the faces around it.
    """
    sides = corners - np.roll(corners, 1, axis=1)
    longest = np.sqrt(np.einsum("tci,tci->tc", sides, sides).max(axis=1))
    turn = np.sqrt(np.einsum("tap,tap->t", rest, rest)) * longest
    return np.asarray((SHARPEST / np.maximum(turn, SHARPEST)) ** 2)


class FaceTurning:
    """How faces (t, 3) at node positions x [m], shape (n, 3), turn when their nodes move.

    Moving a corner out of the plane by d turns the frame by d / (2 area) times the opposite side; moving the
    ends of the first edge across it, in the plane, turns the frame about the normal.
    """

    def __init__(self, faces: Int, x: Float) -> None:
        corners = x[faces]
        self._faces = faces
        self._sides = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]
        self._frames = face_frames(x, faces)
        normal = np.cross(self._sides[:, 0], self._sides[:, 1])
        self._twice_area = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
        self._length = np.maximum(np.linalg.norm(self._sides[:, 2], axis=1), 1e-300)

    def of(self, v: Float) -> Float:
        """Return the turning of the faces [rad/s], shape (t, 3), for velocities (n, 3) [m/s] of the nodes."""
        at_corners = v[self._faces]
        normal = self._frames[:, :, 2]
        rising = np.einsum("tai,ti->ta", at_corners, normal) / self._twice_area[:, None]
        first = at_corners[:, 1] - at_corners[:, 0]
        about_normal = np.einsum("ti,ti->t", first, self._frames[:, :, 1]) / self._length
        return np.asarray(
            np.einsum("ta,tai->ti", rising, self._sides) + about_normal[:, None] * normal, np.float64
        )

    def add_torques(self, torque: Float, forces: Float) -> None:
        """Add to forces (n, 3) [N] those of a torque on each face [N m], shape (t, 3)."""
        out_of_plane = np.einsum("ti,tai->ta", torque, self._sides) / self._twice_area[:, None]
        element = out_of_plane[:, :, None] * self._frames[:, None, :, 2]
        about_normal = np.einsum("ti,ti->t", torque, self._frames[:, :, 2]) / self._length
        element[:, 1] += about_normal[:, None] * self._frames[:, :, 1]
        element[:, 0] -= about_normal[:, None] * self._frames[:, :, 1]
        for axis in range(3):
            forces[:, axis] += np.bincount(self._faces.ravel(), element[:, :, axis].ravel(), len(forces))


class Bending:
    """Quadratic bending of one mesh.

    Attributes
    ----------
    stiffness
        The scalar matrix S [N/m], csr (n, n), sorted int32 indices; the Hessian is S for each of x, y and z.
    second_derivatives
        B: node values to (uu, vv, uv) derivatives per face [1/m^2], csr (3 t, n); S = B^T (area D) B.
    rigidity
        Area times rigidity tensor of every face [N m^3], shape (t, 3, 3).
    """

    nodes = None
    elastic = True

    def __init__(
        self,
        faces: Int,
        rest_corners: Float,
        rigidity: Float,
        node_count: int,
        *,
        topology: Topology | None = None,
        pinned: Bool | None = None,
        rest_positions: Float | None = None,
        rest_curved: Bool | None = None,
    ) -> None:
        """Build the matrix for faces (t, 3) of nodes.

        Parameters
        ----------
        faces, rest_corners
            Nodes (t, 3) and rest shape (t, 3, 2) [m] of every face, the latter in (warp, weft).
        rigidity
            Rigidity tensors [N m], shape (t, 3, 3), from `bending_tensor`.
        node_count
            Number of nodes.
        topology
            Of `faces`, where it is known already; what bends apart is no neighbour.
        pinned
            Nodes that never move, shape (n,): a face with three of them clamps the faces next to it.
        rest_positions
            Shape [m], (n, 3), in which faces of curved rest shape bear no moment; None for flat cloth.
        rest_curved
            Which faces have that rest shape, shape (t,); the others are flat at rest. None means all.
        """
        if topology is None:
            topology = triangle_topology(faces)
        rigid = None if pinned is None else np.asarray(pinned[faces].all(axis=1))
        patches = bending_patches(faces, rest_corners, topology, node_count, rigid)
        self.faces = faces
        self._factor = 1.0
        self.rigidity = rigidity * patches.areas[:, None, None]
        self.second_derivatives = patches.second_derivatives
        self._rest: Float | None = None
        if rest_positions is not None:
            frames = face_frames(rest_positions, faces)
            local = np.einsum("tai,tip->tap", self.second_derivatives_at(rest_positions), frames)
            if rest_curved is not None:
                local[~rest_curved] = 0.0
            self._rest = local
            self.rigidity = self.rigidity * _crease_share(local, rest_corners)[:, None, None]
        rows = np.arange(0, 9 * len(faces) + 1, 3, dtype=np.int32)
        columns = np.repeat(np.arange(3 * len(faces), dtype=np.int32).reshape(-1, 3), 3, axis=0).ravel()
        weight = sp.csr_array((self.rigidity.ravel(), columns, rows))
        stiffness = (self.second_derivatives.T.tocsr() @ (weight @ self.second_derivatives)).tocsr()
        stiffness.sort_indices()
        self.stiffness = sp.csr_array(
            (stiffness.data, stiffness.indices.astype(np.int32), stiffness.indptr.astype(np.int32)),
            shape=(node_count, node_count),
        )

    @classmethod
    def for_cloth(cls, cloth: Cloth) -> "Bending":
        """Return the bending of a cloth, with its fabrics, pins and curved rest shapes; folds are borders."""
        per_face = cloth.per_face
        rest_positions = None
        if cloth.rest_curved.any():
            rest_positions = np.zeros_like(cloth.positions)
            rest_positions[cloth.node] = cloth.start_positions
        topology = None
        if cloth.folds is not None:
            topology = cloth.folds.cut(triangle_topology(cloth.face_nodes), cloth.faces, cloth.uv)
        return cls(
            cloth.face_nodes,
            cloth.rest_corners,
            bending_tensor(per_face("bending_warp"), per_face("bending_weft"), per_face("bending_bias")),
            len(cloth.positions),
            topology=topology,
            pinned=cloth.pinned if cloth.pinned.any() else None,
            rest_positions=rest_positions,
            rest_curved=cloth.rest_curved,
        )

    @property
    def constant_matrix(self) -> sp.csr_array:
        """The scalar matrix S [N/m]: the whole Hessian."""
        return self.stiffness

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the factor on the rigidity from the request; `energy` stays that of the fabric."""
        self._factor = step.request.bending_factor
        return True

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the derivative of the energy [N], times the factor, to an array of shape (n, 3)."""
        gradient += self._factor * self.gradient(x)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient; the constant matrix counts with the factor."""
        self.add_gradient(x, gradient)
        hessian.scale_constant(self._factor)

    def second_derivatives_at(self, x: Float) -> Float:
        """Return second derivatives (uu, vv, uv) of positions x [1/m], shape (t, 3, 3), last axis x, y, z."""
        return np.asarray(self.second_derivatives @ x).reshape(-1, 3, 3)

    def bent(self, x: Float) -> Float:
        """Return second derivatives (uu, vv, uv) less those at rest [1/m], shape (t, 3, 3)."""
        derivatives = self.second_derivatives_at(x)
        return derivatives if self._rest is None else derivatives - self._rest_derivatives(x)

    def _rest_derivatives(self, x: Float) -> Float:
        """Rest derivatives turned along with the faces at x [1/m], shape (t, 3, 3)."""
        assert self._rest is not None
        turned: Float = np.einsum("tap,tip->tai", self._rest, face_frames(x, self.faces))
        return turned

    def energy(self, x: Float) -> float:
        """Bending energy [J] at node positions x [m], shape (n, 3)."""
        if self._rest is None:
            return 0.5 * float(np.vdot(x, self.stiffness @ x))
        bent = self.bent(x)
        return 0.5 * float(np.einsum("tai,tab,tbi->", bent, self.rigidity, bent))

    def gradient(self, x: Float) -> Float:
        """Gradient of the energy [N], shape (n, 3)."""
        forces: Float = np.asarray(self.stiffness @ x)
        if self._rest is not None:
            rest = self._rest_derivatives(x)
            moments = np.einsum("tab,tbi->tai", self.rigidity, rest)
            forces -= self.second_derivatives.T @ moments.reshape(-1, 3)
            torque = np.cross(self.second_derivatives_at(x), moments).sum(axis=1)
            self.turning(x).add_torques(torque, forces)
        return forces

    def turning(self, x: Float) -> "FaceTurning":
        """Return how the faces at x [m], shape (n, 3), turn with their nodes."""
        return FaceTurning(self.faces, x)

    def curvature(self, x: Float) -> Float:
        """Return curvatures (uu, vv, uv) of each face along its normal [1/m], shape (t, 3)."""
        along: Float = np.einsum(
            "tai,ti->ta", self.second_derivatives_at(x), face_frames(x, self.faces)[:, :, 2]
        )
        return along
