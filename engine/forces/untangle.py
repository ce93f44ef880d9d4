"""Untangling: forces that shorten the curves along which cloth crosses itself, until nothing crosses.

Where an edge of face A pierces face B, the crossing curve starts at the piercing point and runs into A along
R. Let the edge, of direction E, move by d against B with normal N: the piercing point moves by
d - (d . N)/(E . N) E, so the curve's length falls fastest along

    G = R - (E . R)/(E . N) N,

summed over the two faces of the edge (intersection contour minimisation, Volino and Magnenat-Thalmann 2006).
Edge and face are drawn apart along G, and only along it, by springs towards places ahead of them. A curve
around a bump that pokes through draws the bump back; a curve that starts at a border draws the border across.
No side needs to be the right one, so tangles of any history come loose. A straight curve has no way to become
shorter: it is left to stretch and bending.
"""

import numpy as np

from toile.collide.audit import crossings_within
from toile.engine.forces.force import NodalForce, StepState
from toile.engine.solve.hessian import Hessian
from toile.engine.solve.linear_system import ContactStencils
from toile.geometry.arrays import Float, Int

REACH = 0.003
"""How far ahead the springs reach [m]: with their stiffness, the largest force."""
STEEPEST = 4.0
"""Bound on (E . R)/(E . N), for edges that lie almost in the face they pierce."""
FAINT = 0.3
"""Length of G at which a curve pulls at 0.7 of full strength."""


class Untangling(NodalForce):
    """Springs at the points where edges pierce faces, found by `evaluate`; a request gives their stiffness.

    Attributes
    ----------
    faces
        Faces of cloth and avatar that may cross, vertex triples (t, 3).
    weld
        Future node of every vertex: faces on two sides of an open seam do not count, shape (v,).
    cloth_nodes
        Number of leading vertices that are nodes of the cloth; the others belong to the avatar.
    positions
        All vertices, those of the avatar as they are [m], shape (v, 3).
    ends, weights
        Nodes of every spring's end and their shares in its place, shape (k, 4); -1 where unused or avatar.
    direction
        Unit vector along which each end is drawn, shape (k, 3).
    strength
        Share of the stiffness that each spring has, 0 to 1, shape (k,).
    """

    def __init__(self, faces: Int, weld: Int, cloth_nodes: int, positions: Float) -> None:
        """Build; `positions` is the array in which the contact search keeps all vertices, cloth first."""
        self.faces = faces
        self.weld = weld
        self.cloth_nodes = cloth_nodes
        self.positions = positions
        self._stiffness = 0.0
        self._before: Float = np.empty((0, 3))
        self.ends = np.empty((0, 4), np.int32)
        self.weights = np.empty((0, 4))
        self.direction = np.empty((0, 3))
        self.strength = np.empty(0)

    def begin(self, step: StepState, x: Float) -> bool:
        """Take the stiffness [N/m] from the request: without any nothing is drawn apart."""
        self._stiffness = step.request.untangle_stiffness
        return self._stiffness > 0.0

    def energy(self, x: Float) -> float:
        """Energy of the springs as found last [J]: each draws its end by half of REACH."""
        return float(0.5 * self._stiffness * np.sum(self.strength * self._short_of(x) ** 2))

    def linearise(self, x: Float, gradient: Float, hessian: Hessian) -> None:
        """Find what crosses where the vertices are, and add gradient and Hessian."""
        self.evaluate(self.positions)
        self.add_gradient(x, gradient)
        hessian.add_stencils(self.stencils())

    def _short_of(self, x: Float) -> Float:
        """How far every end is from where its spring draws it, against the direction [m], shape (k,)."""
        return np.asarray(np.einsum("ki,ki->k", self._places(x) - self._before, self.direction) - 0.5 * REACH)

    def _places(self, x: Float) -> Float:
        """Share of the cloth in the place of every end [m], shape (k, 3)."""
        own = np.where(self.ends >= 0, self.weights, 0.0)
        return np.asarray(np.einsum("kq,kqi->ki", own, x[np.maximum(self.ends, 0)]))

    def evaluate(self, x: Float) -> None:
        """Find the crossing curves at vertex positions x [m], shape (v, 3), and what shortens them."""
        pairs = crossings_within(x, self.faces, self.weld)
        # Where the avatar crosses itself nothing can be done.
        pairs = pairs[(self.faces[pairs] < self.cloth_nodes).any(axis=(1, 2))]
        one, other = self.faces[pairs].transpose(1, 0, 2)
        edges, triangles, share, inside, directions = [], [], [], [], []
        for a, b in ((one, other), (other, one)):
            for corner in range(3):
                edge = np.stack([a[:, corner], a[:, (corner + 1) % 3]], axis=1)
                found = _pierced(x, edge, a[:, (corner + 2) % 3], b)
                edges.append(edge[found.rows])
                triangles.append(b[found.rows])
                share.append(found.share)
                inside.append(found.inside)
                directions.append(found.direction)
        edge, triangle = np.concatenate(edges), np.concatenate(triangles)
        # Both faces of an edge report it: one spring gets the sum of their directions.
        keys = np.concatenate([np.sort(edge, axis=1), triangle], axis=1)
        _, first, label = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        total = np.zeros((len(first), 3))
        np.add.at(total, label.reshape(-1), np.concatenate(directions))
        size = np.linalg.norm(total, axis=1)
        strength = size / np.sqrt(size**2 + FAINT**2)
        count = len(first)
        self.ends = np.full((2 * count, 4), -1, np.int32)
        self.weights = np.zeros((2 * count, 4))
        self.ends[:count, :2], self.ends[count:, :3] = edge[first], triangle[first]
        s = np.concatenate(share)[first]
        self.weights[:count, 0], self.weights[:count, 1] = 1.0 - s, s
        self.weights[count:, :3] = np.concatenate(inside)[first]
        self.ends[self.ends >= self.cloth_nodes] = -1
        self.direction = np.concatenate([_unit(total), -_unit(total)])
        self.strength = np.concatenate([strength, strength])
        self._before = self._places(x)

    def add_gradient(self, x: Float, gradient: Float) -> None:
        """Add the gradient of the springs as found last [N] to an array of shape (n, 3)."""
        pull = (self._short_of(x) * self._stiffness * self.strength)[:, None] * self.direction
        for q in range(3):
            used = self.ends[:, q] >= 0
            np.add.at(gradient, self.ends[used, q], self.weights[used, q, None] * pull[used])

    def stencils(self) -> ContactStencils:
        """Return the Hessian as stencils of two and three nodes, stiff along the direction only."""
        along = self.direction[:, :, None] * self.direction[:, None, :]
        return ContactStencils(
            self.ends, self.weights, self._stiffness * self.strength[:, None, None] * along
        )


class _Pierced:
    """Rows in which the edge pierces the face: share along the edge, weights within the face, direction G."""

    def __init__(self, rows: Int, share: Float, inside: Float, direction: Float) -> None:
        self.rows = rows
        self.share = share
        self.inside = inside
        self.direction = direction


def _pierced(x: Float, edge: Int, third: Int, triangle: Int) -> _Pierced:
    """Find where edges (k, 2) of faces with third corner (k,) pierce triangles (k, 3)."""
    start, end = x[edge[:, 0]], x[edge[:, 1]]
    corner = x[triangle[:, 0]]
    first, second = x[triangle[:, 1]] - corner, x[triangle[:, 2]] - corner
    normal = _unit(np.cross(first, second))
    below, above = _dot(start - corner, normal), _dot(end - corner, normal)
    share = below / np.where(below == above, 1.0, below - above)
    place = start + share[:, None] * (end - start) - corner
    uu, uv, vv = _dot(first, first), _dot(first, second), _dot(second, second)
    pu, pv = _dot(place, first), _dot(place, second)
    size = np.maximum(uu * vv - uv * uv, 1e-300)
    b, c = (vv * pu - uv * pv) / size, (uu * pv - uv * pu) / size
    apart = (edge[:, :, None] != triangle[:, None, :]).all(axis=(1, 2))
    hit = apart & (below * above < 0.0) & (b >= 0.0) & (c >= 0.0) & (b + c <= 1.0)
    rows = np.flatnonzero(hit).astype(np.int32)
    along = _unit((end - start)[rows])
    inward = (x[third] - start)[rows]
    inward = inward - along * _dot(inward, along)[:, None]
    curve = _unit(np.cross(np.cross(along, inward), normal[rows]))
    curve *= np.where(_dot(curve, inward) >= 0.0, 1.0, -1.0)[:, None]
    rise = _dot(along, normal[rows])
    lean = np.clip(_dot(along, curve) / np.where(rise == 0.0, 1e-300, rise), -STEEPEST, STEEPEST)
    inside = np.stack([1.0 - b - c, b, c], axis=1)[rows]
    return _Pierced(rows, share[rows], inside, curve - lean[:, None] * normal[rows])


def _dot(a: Float, b: Float) -> Float:
    return np.asarray(np.einsum("ij,ij->i", a, b))


def _unit(vectors: Float) -> Float:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300))
