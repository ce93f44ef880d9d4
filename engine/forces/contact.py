"""Contact: a barrier on the gap of close pairs.

Per pair with gap d below the contact radius r, area A and stiffness kappa [Pa/m]:
quadratic kappa A (r - d)^2 / 2 down to r / 2, logarithmic below (force kappa A r^2 / (4 d)), so that the
force is smooth and grows without limit as the gap closes (activation of Chen et al. 2025, eq. 18-20).

Cloth in motion may cross the radius within one step. A pair that the motion to come would bring closer is a
contact already: the quadratic law, extended to d > r, makes the linear solve end at the gap r, so that an
impact takes one step of any size, and cloth a hair's breadth off the surface does not fall on it anew. It
would as well hold back what leaves: `engine.forces.friction` lets go what pulls.

An avatar that moves in a step counts with the gap and the slip that its motion alone leads to: its cloth is
pushed and dragged within the same linear solve.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numba import types

from toile.collide.pair_distance import length, pair_weights, separation, spanned_normal, weighted_sum
from toile.engine.forces.near_pairs import near_pairs, radius_of
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import (
    F64_1,
    F64_2,
    I32_1,
    I32_2,
    OUT_F64_1,
    OUT_F64_2,
    OUT_F64_3,
    OUT_I32_2,
    helper,
    kernel,
    unsigned,
)

NO_MOTION = np.empty((0, 3))
FACING = 0.999999
"""Cosine between closest direction and normal from which a pair meets face to face, not sideways."""
CLOSEST = 0.1
"""Least gap that an avatar in motion is taken to leave, as a share of the contact radius."""


@dataclass(frozen=True)
class Contacts:
    """Active contacts of one evaluation; rows of `nodes` index cloth nodes, -1 is an avatar vertex.

    Attributes
    ----------
    nodes, weights
        The four vertices of a pair and their weights in the gap vector, shape (c, 4).
    normal
        Unit vector along which the pair is pushed apart, shape (c, 3).
    push
        Force along it [N], shape (c,).
    hard
        How fast that falls as the gap opens [N/m], shape (c,).
    slid
        Slip along the surface since the anchors [m], shape (c, 3).
    friction
        Coulomb coefficient, shape (c,).
    force
        Force on the pair [N]: vertex q receives weights[q] * force, shape (c, 3).
    stiffness
        Positive semi-definite stiffness [N/m], shape (c, 3, 3).
    gap
        Distance [m], shape (c,).
    vertices
        The four vertices of a pair, nodes first, then avatar vertices, shape (c, 4).
    body
        Number of leading rows whose other side is the avatar.
    energy
        Barrier energy [J].
    distances
        Of all (vertex-face, edge-edge) candidates against the avatar, and within the cloth [m].
    """

    nodes: Int
    weights: Float
    normal: Float
    push: Float
    hard: Float
    slid: Float
    friction: Float
    force: Float
    stiffness: Float
    gap: Float
    vertices: Int
    body: int
    energy: float
    distances: tuple[tuple[Float, Float], tuple[Float, Float]]

    @property
    def count(self) -> int:
        """Number of active contacts."""
        return len(self.gap)

    def touched(self, count: int) -> Bool:
        """Mark the nodes of all contacts, shape (count,)."""
        mask = np.zeros(count, bool)
        mask[self.nodes[self.nodes >= 0]] = True
        return mask

    def pressing(self, push: Float, hard: Float, grip: Float) -> "Contacts":
        """Return the contacts with other forces [N] and stiffnesses [N/m] along, and `grip` across, (c,)."""
        force, stiffness = np.empty((self.count, 3)), np.empty((self.count, 3, 3))
        _press(self.normal, self.slid, push, hard, grip, force, stiffness)
        return replace(self, force=force, stiffness=stiffness)

    def add_gradient(self, gradient: Float, ahead: Float | None = None) -> None:
        """Subtract contact forces [N] from a gradient, shape (n, 3).

        With `ahead` they are those, to first order, after nodes moved so far [m], shape (n, 3).
        """
        force = self.force
        if ahead is not None:
            moved = np.where((self.nodes >= 0)[:, :, None], ahead[self.nodes], 0.0)
            opened = np.einsum("cq,cqi->ci", self.weights, moved)
            force = force - np.einsum("cij,cj->ci", self.stiffness, opened)
        _subtract_forces(self.nodes, self.weights, np.ascontiguousarray(force), gradient)


@kernel(types.void(F64_2, F64_2, F64_1, F64_1, F64_1, OUT_F64_2, OUT_F64_3))
def _press(normal, slid, push, hard, grip, force, stiffness):  # type: ignore[no-untyped-def]
    """Write forces and stiffnesses of contacts that press and grip."""
    for c in range(normal.shape[0]):
        for i in range(3):
            force[c, i] = push[c] * normal[c, i] - grip[c] * slid[c, i]
            for j in range(3):
                along = normal[c, i] * normal[c, j]
                same = 1.0 if i == j else 0.0
                stiffness[c, i, j] = hard[c] * along + grip[c] * (same - along)


@kernel(types.void(I32_2, F64_2, F64_2, OUT_F64_2))
def _subtract_forces(nodes: Int, weights: Float, force: Float, gradient: Float) -> None:
    """Subtract weights times forces from the gradient at the nodes of contacts."""
    for corner in range(4):
        # Summed before it is subtracted: less is lost where a node's contacts balance.
        total = np.zeros(gradient.shape)
        for c in range(nodes.shape[0]):
            i = nodes[c, corner]
            if i >= 0:
                for axis in range(3):
                    total[i, axis] += weights[c, corner] * force[c, axis]
        for i in range(gradient.shape[0]):
            for axis in range(3):
                gradient[i, axis] -= total[i, axis]


@helper
def _slides_past(p, ahead, kind, i, j, k, m, x, y, z, gap, four):  # type: ignore[no-untyped-def]
    """Whether the normal of face or edges keeps a pair apart by `gap` before and after the motion `ahead`.

    Cloth that slides over a surface passes edges and faces ahead whose closest points, (x, y, z) apart, lie
    sideways.
    """
    nx, ny, nz = spanned_normal(p, kind, i, j, k, m, x, y, z)
    for time in range(2):
        for axis in range(3):
            four[0, axis] = p[i, axis] + time * ahead[i, axis]
            four[1, axis] = p[j, axis] + time * ahead[j, axis]
            four[2, axis] = p[k, axis] + time * ahead[k, axis]
            four[3, axis] = p[m, axis] + time * ahead[m, axis]
        if separation(four, kind, 0, 1, 2, 3, nx, ny, nz) < gap:
            return False
    return True


@kernel(
    types.int64(
        F64_2, F64_2, types.int64, I32_2, I32_1, types.int64, F64_1, F64_1, types.float64, types.float64,
        F64_2, types.boolean, types.int64, OUT_I32_2, OUT_F64_2, OUT_F64_2, OUT_F64_1, OUT_F64_1, OUT_F64_2,
        OUT_F64_1, OUT_I32_2, OUT_F64_1,
    )
)  # fmt: skip
def _evaluate(  # type: ignore[no-untyped-def]
    p, p_start, cloth_nodes, pairs, rows, kind, radius, area, kappa, radius_share, ahead, halves, begin,
    nodes, weights, normal, push_of, hard_of, slid_of, gap, vertices, energy,
):  # fmt: skip
    """Append the active ones among rows of one list from row `begin`; return the new row count."""
    count = begin
    w = np.empty(4, np.float64)
    four = np.empty((4, 3), np.float64)
    for number in range(rows.shape[0]):
        row = unsigned(rows[number])
        i = unsigned(pairs[row, 0])
        j = unsigned(pairs[row, 1])
        k = unsigned(pairs[row, 2])
        m = unsigned(pairs[row, 3])
        r = radius_of(radius, kind, i, j, k, m, radius_share, halves)
        w[0], w[1], w[2], w[3] = pair_weights(p, kind, i, j, k, m)
        x, y, z = weighted_sum(p, i, j, k, m, w[0], w[1], w[2], w[3])
        d = length(x, y, z)
        nx = x / d
        ny = y / d
        nz = z / d
        sx = 0.0
        sy = 0.0
        sz = 0.0
        meeting = d
        if ahead.shape[0] > 0:
            for q in range(4):
                v = pairs[row, q]
                meeting += w[q] * (nx * ahead[v, 0] + ny * ahead[v, 1] + nz * ahead[v, 2])
                if v >= cloth_nodes:
                    sx += w[q] * ahead[v, 0]
                    sy += w[q] * ahead[v, 1]
                    sz += w[q] * ahead[v, 2]
        # The gap that the avatar's motion alone leads to.
        left = d + nx * sx + ny * sy + nz * sz
        if d >= r or left >= r:
            if meeting >= r:
                continue
            ox, oy, oz = spanned_normal(p, kind, i, j, k, m, x, y, z)
            facing = abs(nx * ox + ny * oy + nz * oz) > FACING
            if not facing and (
                meeting >= 0.5 * r or _slides_past(p, ahead, kind, i, j, k, m, x, y, z, 0.5 * r, four)
            ):
                continue
        # Both sides press on the smaller of their two patches, whatever the other mesh's triangles are.
        patch = abs(w[0]) * area[i]
        other = abs(w[2]) * area[k] + abs(w[3]) * area[m]
        if kind == 0:
            other += abs(w[1]) * area[j]
        else:
            patch += abs(w[1]) * area[j]
        patch = 2.0 * min(patch, other)
        scale = 0.5 * kappa * patch
        if left >= 0.5 * r:
            push = scale * (r - left)
            hard = scale
            energy[0] += 0.5 * scale * (r - left) * (r - left)
        else:
            # An avatar that would pass through the cloth pushes it as if it had come this close.
            close = max(left, min(d, CLOSEST * r))
            push = scale * r * r / (4.0 * close)
            # Secant to the gap r where the force ends: the tangent would let Newton only double the gap.
            hard = push / (r - close)
            push += hard * (close - left)
            energy[0] += scale * r * r * (0.125 - 0.25 * np.log(2.0 * close / r))
        for q in range(4):
            v = pairs[row, q]
            sx += w[q] * (p[v, 0] - p_start[v, 0])
            sy += w[q] * (p[v, 1] - p_start[v, 1])
            sz += w[q] * (p[v, 2] - p_start[v, 2])
        along = sx * nx + sy * ny + sz * nz
        sx -= along * nx
        sy -= along * ny
        sz -= along * nz
        slid_of[count, 0] = sx
        slid_of[count, 1] = sy
        slid_of[count, 2] = sz
        normal[count, 0] = nx
        normal[count, 1] = ny
        normal[count, 2] = nz
        push_of[count] = push
        hard_of[count] = hard
        gap[count] = d
        for q in range(4):
            v = pairs[row, q]
            weights[count, q] = w[q]
            vertices[count, q] = v
            nodes[count, q] = v if v < cloth_nodes else -1
        count += 1
    return count


@dataclass(frozen=True, kw_only=True)
class ContactLaw:
    """Parameters of contact between two surfaces.

    Attributes
    ----------
    stiffness
        Pressure per depth [Pa/m].
    edge_share
        Contact radius of edge-edge pairs as a share of the vertex-face radius: on smooth surfaces
        vertices carry the load, and edges only need to take over where the surface is sharp.
    """

    stiffness: float
    edge_share: float


class PairFriction(NamedTuple):
    """Coulomb coefficients between materials.

    Attributes
    ----------
    material
        Material of every vertex, shape (n,).
    table
        Coefficient of two materials, shape (m, m), symmetric.
    """

    material: Int
    table: Float

    def of(self, vertices: Int) -> Float:
        """Coefficients of pairs of four vertices, shape (c, 4): the first and third are of its two sides."""
        sides = self.material[vertices[:, [0, 2]]]
        return np.asarray(self.table[sides[:, 0], sides[:, 1]])


class Meeting(NamedTuple):
    """Surfaces that can meet: (vertex-face, edge-edge) candidates, radius per vertex [m], (n,), law."""

    pairs: tuple[Int, Int]
    radius: Float
    law: ContactLaw


def evaluate_contacts(
    p: Float, p_start: Float, cloth_nodes: int, body: Meeting, cloth: Meeting, area: Float,
    pair_friction: PairFriction, ahead: Float = NO_MOTION,
) -> Contacts:  # fmt: skip
    """Evaluate all candidate pairs at positions p, without friction.

    Parameters
    ----------
    p, p_start
        Cloth nodes followed by avatar vertices now and at their anchors [m], shape (n, 3).
    body, cloth
        Cloth against the avatar, where a pair uses its smallest radius, and against itself, where each side
        gives half of its smallest.
    area
        Area per vertex [m^2], shape (n,).
    pair_friction
        Coulomb coefficients.
    ahead
        Motion to come [m], shape (n, 3): pairs that it would bring closer than the radius are contacts
        already. Without it only pairs within the radius are. That of avatar vertices is certain: gap and slip
        count as after it.
    """
    of_body, of_cloth = ((np.empty(len(a)), np.empty(len(b))) for a, b in (body.pairs, cloth.pairs))
    near = [
        near_pairs(
            p, pairs, kind, meeting.radius, meeting.law.edge_share if kind else 1.0, ahead, halves,
            distances[kind],
        )
        for meeting, halves, distances in ((body, False, of_body), (cloth, True, of_cloth))
        for kind, pairs in enumerate(meeting.pairs)
    ]  # fmt: skip
    capacity = sum(map(len, near))
    nodes, vertices = np.empty((capacity, 4), np.int32), np.empty((capacity, 4), np.int32)
    weights, normal, slid = np.empty((capacity, 4)), np.empty((capacity, 3)), np.empty((capacity, 3))
    push, hard, gap = (np.empty(capacity) for _ in range(3))
    energy = np.zeros(1)
    count = 0
    touching_body = 0
    for meeting in (body, cloth):
        pairs_of, radius, law = meeting
        for kind in (0, 1):
            rows = near[2 * (meeting is cloth) + kind]
            if len(rows):
                share = law.edge_share if kind else 1.0
                count = _evaluate(
                    p, p_start, cloth_nodes, pairs_of[kind], rows, kind, radius, area, law.stiffness, share,
                    ahead, meeting is cloth, count, nodes, weights, normal, push, hard, slid, gap, vertices,
                    energy,
                )  # fmt: skip
        if meeting is body:
            touching_body = count
    normal, push, hard = normal[:count], push[:count], hard[:count]
    return Contacts(
        nodes=nodes[:count], weights=weights[:count], normal=normal, push=push, hard=hard, slid=slid[:count],
        friction=pair_friction.of(vertices[:count]), force=push[:, None] * normal,
        stiffness=hard[:, None, None] * (normal[:, :, None] * normal[:, None, :]), gap=gap[:count],
        vertices=vertices[:count], body=touching_body, energy=float(energy[0]),
        distances=(of_body, of_cloth),
    )  # fmt: skip
