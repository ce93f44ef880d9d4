"""Fastened points as a force: what draws buttons into their holes, and the two sides of a zip together.

With d from the point of the side beneath to that of the side on top, n the unit normal there, o the distance:

    on a side    r = |d - o n|,    d - o n = 0 where it is fastened
    else         r = max(|d| - o, 0)
    E = k/2 r^2 while k r < F, else F r - F^2/(2 k)

so that a pair never pulls with more than F. n turns with the cloth, and so the force and the torque on the
whole are nothing.
"""

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.fastenings import Fastening, found_points
from toile.engine.forces.force import ElementForce, StepState
from toile.engine.solve.assembly import node_pairs, scatter_gradients
from toile.engine.solve.hessian import Hessian
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.normals import area_normals

LEAST = 1e-12
"""Length [m] and area [m^2] below which there is no direction."""
PAIRS = node_pairs(6)


class FasteningPull(ElementForce):
    """The fastened points of a cloth whose seams are closed.

    Attributes
    ----------
    nodes
        Nodes of the face on top and of the face beneath, shape (k, 6).
    weights
        Weights of the point on top, and minus those of the point beneath, shape (k, 6).
    """

    def __init__(
        self, rows: tuple[Fastening, ...], nodes: Int, weights: Float, kept: Bool, now: float
    ) -> None:
        self._rows, self._kept = rows, kept
        self.nodes: Int = nodes
        self.weights = weights
        side = np.concatenate([np.full(len(row.over_points), row.side) for row in rows])[kept]
        distance = np.concatenate([np.full(len(row.over_points), row.distance) for row in rows])[kept]
        self._aside = side != 0
        self._offset: Float = np.where(self._aside, side * distance, distance)
        self._stiffness = np.concatenate([row.stiffness for row in rows])[kept]
        self._most = np.concatenate([row.most for row in rows])[kept]
        self._acting = self._at(now)

    @classmethod
    def for_cloth(cls, cloth: Cloth) -> "FasteningPull | None":
        """Return the force of a cloth; None where nothing is fastened, or while seams are open.

        Pairs whose faces share a node, at the end of a seam, say, are held there already.
        """
        if not cloth.fastenings or len(cloth.stitches):
            return None
        corners, faces = cloth.rest_space[cloth.faces], cloth.face_nodes
        nodes, weights = [], []
        for row in cloth.fastenings:
            found = []
            for (garment, panel), points in ((row.over, row.over_points), (row.under, row.under_points)):
                chosen = np.flatnonzero((cloth.garment == garment) & (cloth.panel == panel))
                found.append(found_points(points, chosen.astype(np.int32), corners))
            nodes.append(np.concatenate([faces[side.face] for side in found], axis=1))
            weights.append(np.concatenate([found[0].weights, -found[1].weights], axis=1))
        every = np.concatenate(nodes)
        kept = ~(every[:, :3, None] == every[:, None, 3:]).any(axis=(1, 2))
        if not kept.any():
            return None
        return cls(
            cloth.fastenings, np.ascontiguousarray(every[kept], np.int32), np.concatenate(weights)[kept],
            kept, cloth.now,
        )  # fmt: skip

    def _at(self, seconds: float) -> Float:
        return np.asarray(np.concatenate([row.acting(seconds) for row in self._rows])[self._kept])

    def begin(self, step: StepState, x: Float) -> bool:
        """Take how much acts at the end of the step; without anything closed it does not act."""
        self._acting = self._at(step.request.seconds)
        return bool(self._acting.any())

    def _away(self, x: Float) -> Float:
        """Return by how much pairs are away from where they are fastened [m], shape (k, 3)."""
        apart = np.einsum("kq,kqi->ki", self.weights, x[self.nodes])
        normal, _ = self._normals(x)
        length = np.linalg.norm(apart, axis=1)
        slack = np.maximum(length - self._offset, 0.0) / np.maximum(length, LEAST)
        shank = apart - self._offset[:, None] * normal
        return np.asarray(np.where(self._aside[:, None], shank, slack[:, None] * apart))

    def _normals(self, x: Float) -> tuple[Float, Float]:
        """Return unit normals of the faces beneath, shape (k, 3), and twice their areas [m^2], (k,)."""
        area = area_normals(x[self.nodes[:, 3:]])
        size = np.maximum(np.linalg.norm(area, axis=1), LEAST)
        return area / size[:, None], size

    def pull(self, x: Float) -> Float:
        """Force that draws each pair together at positions x [N], shape (k,)."""
        return self._pull(np.linalg.norm(self._away(x), axis=1))

    def _pull(self, length: Float) -> Float:
        """Return that force for how far pairs are away [m], shape (k,)."""
        return np.asarray(self._acting * np.minimum(self._stiffness * length, self._most))

    def energy(self, x: Float) -> float:
        """Energy [J] at node positions x [m], shape (n, 3)."""
        away = np.linalg.norm(self._away(x), axis=1)
        near = np.minimum(away, self._most / self._stiffness)
        return float((self._acting * self._stiffness * near) @ (away - 0.5 * near))

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the derivative of the energy [N] to an array of shape (n, 3)."""
        self._add_pull(self._away(x), self._turns(x), gradient)

    def _add_pull(self, away: Float, turns: Float, gradient: Float) -> None:
        """Add the gradient from `_away`, shape (k, 3), and its derivatives, shape (k, 6, 3, 3)."""
        length = np.linalg.norm(away, axis=1)
        force = (self._pull(length) / np.maximum(length, LEAST))[:, None] * away
        scatter_gradients(self.nodes, np.einsum("kqji,kj->kqi", turns, force), gradient)

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Add the gradient, and the second derivatives without those of the normal: Gauss and Newton's."""
        away, turns = self._away(x), self._turns(x)
        self._add_pull(away, turns, gradient)
        length = np.linalg.norm(away, axis=1)
        along = away / np.maximum(length, LEAST)[:, None]
        # Across the pull it is as stiff as its force over the distance: of links that is |d|.
        apart = np.linalg.norm(np.einsum("kq,kqi->ki", self.weights, x[self.nodes]), axis=1)
        lever = np.where(self._aside, length, apart)
        pull = self._pull(length)
        stiff = self._acting * self._stiffness
        yields = self._stiffness * length > self._most
        onward = np.where(yields, 0.0, stiff)
        slack = ~self._aside & (length <= 0.0)
        onward[slack] = 0.0
        short = self._aside & (length <= LEAST)
        across = np.where(short, stiff, pull / np.maximum(lever, LEAST))
        square = along[:, :, None] * along[:, None]
        block = across[:, None, None] * (np.eye(3) - square) + onward[:, None, None] * square
        blocks = np.stack(
            [
                np.einsum("kji,kjl,klm->kim", turns[:, one], block, turns[:, other])
                for one, other in PAIRS
            ],
            axis=1,
        )  # fmt: skip
        hessian.add_elements(self.nodes, np.ascontiguousarray(blocks))

    def _turns(self, x: Float) -> Float:
        """Return derivatives of `_away` by every node, (k, 6, 3, 3); of links those of the way between."""
        turns = self.weights[:, :, None, None] * np.eye(3)
        normal, size = self._normals(x)
        a, b, c = (x[self.nodes[:, corner]] for corner in (3, 4, 5))
        first, second = _crossing(b - a), _crossing(c - a)
        scale = np.where(self._aside, self._offset / size, 0.0)[:, None, None]
        flat = scale * (np.eye(3) - normal[:, :, None] * normal[:, None])
        turns[:, 3] -= flat @ (second - first)
        turns[:, 4] += flat @ second
        turns[:, 5] -= flat @ first
        return np.asarray(turns)


def _crossing(vectors: Float) -> Float:
    """Matrices that cross vectors, shape (k, 3), with what they are applied to, shape (k, 3, 3)."""
    x, y, z = vectors.T
    none = np.zeros(len(vectors))
    return np.stack(
        [np.stack([none, -z, y], axis=1), np.stack([z, none, -x], axis=1), np.stack([-y, x, none], axis=1)],
        axis=1,
    )
