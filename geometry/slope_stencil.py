"""Weights for the derivative across a side from values at the nodes around it, exact on quadratics."""

from math import sqrt

import numpy as np
from numba import types

from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.kernel import BOOL_1, F64_3, I32_2, OUT_F64_2, OUT_I32_1, OUT_I32_2, helper, kernel

MAX_NODES = 48
MAX_FACES = 64
MAX_RINGS = 4
FLATTEST = 1e-6
"""Least height of a triangle, per length of the side below it: keeps a face without area finite."""
AMPLIFICATION_LIMIT = 8.0
"""Largest accepted sum of |weights| times the hinge's height (the four-node formula has 1 to 2)."""
EXACTNESS = 1e-9
"""Largest accepted error of the formula on the scaled monomials of degree two."""
RIDGE = 1e-9
"""Keeps the fit solvable where the nodes lie on a conic; such fits fail the two limits above."""
LAST_RIDGE = 1e-2
"""Ridge where all of a tiny mesh is too little for a quadratic: exact on linear functions only."""
RING_WEIGHT = 0.5
"""Weight of a node in the fit per ring of faces away from the side; 0.1 to 1 change a cantilever by 0.1 %."""


@helper
def _factorise(matrix: Float) -> None:
    """Replace a symmetric positive definite matrix by its Cholesky factor."""
    size = len(matrix)  # not a constant 6: unrolled loops take a second to compile
    for i in range(size):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            if i == j:
                matrix[i, i] = sqrt(max(total, 1e-300))
            else:
                matrix[i, j] = total / matrix[j, j]


@helper
def _substitute(matrix: Float, right: Float, solution: Float) -> None:
    """Solve with a Cholesky factor."""
    size = len(right)
    for i in range(size):
        total = right[i]
        for k in range(i):
            total -= matrix[i, k] * solution[k]
        solution[i] = total / matrix[i, i]
    for i in range(size - 1, -1, -1):
        total = solution[i]
        for k in range(i + 1, size):
            total -= matrix[k, i] * solution[k]
        solution[i] = total / matrix[i, i]


@helper
def _fit(
    count: int,
    s: Float,
    n: Float,
    ring_weights: Float,
    scale_s: float,
    scale_n: float,
    ridge: float,
    basis: Float,
    matrix: Float,
    residual: Float,
    update: Float,
    weights: Float,
) -> tuple[float, float]:
    """Fill weights of d/dn at the origin; return (amplification, misfit).

    The weights c minimise sum c_i^2 / w_i + |misfit on s^2/2, s n, n^2/2|^2 / ridge while exact on 1, s, n:
    c = W P (P^T W P + ridge)^-1 e, repeated on what is left of e, which drives the misfit of a solvable fit
    to rounding. Coordinates are scaled by the size of the hinge along and across the side.
    """
    size = len(residual)
    for i in range(count):
        a, b = s[i] / scale_s, n[i] / scale_n
        basis[i, 0], basis[i, 1], basis[i, 2] = 1.0, a, b
        basis[i, 3], basis[i, 4], basis[i, 5] = 0.5 * a * a, a * b, 0.5 * b * b
        weights[i] = 0.0
    for p in range(size):
        for q in range(p + 1):
            total = 0.0
            for i in range(count):
                total += ring_weights[i] * basis[i, p] * basis[i, q]
            matrix[p, q] = total
    for p in range(3, size):
        matrix[p, p] += ridge
    _factorise(matrix)
    rounds = 4 if ridge < 1e-6 else 2
    for _ in range(rounds):
        for q in range(size):
            total = 1.0 if q == 2 else 0.0
            for i in range(count):
                total -= basis[i, q] * weights[i]
            residual[q] = total
        _substitute(matrix, residual, update)
        for i in range(count):
            total = 0.0
            for q in range(size):
                total += basis[i, q] * update[q]
            weights[i] += ring_weights[i] * total
    misfit = 0.0
    for q in range(size):
        total = 1.0 if q == 2 else 0.0
        for i in range(count):
            total -= basis[i, q] * weights[i]
        misfit = max(misfit, abs(total))
    amplification = 0.0
    for i in range(count):
        amplification += abs(weights[i])
        weights[i] /= scale_n
    return amplification, misfit


@helper
def _add_node(
    node: int,
    s_value: float,
    n_value: float,
    ring_weight: float,
    count: int,
    nodes: Int,
    s: Float,
    n: Float,
    ring_weights: Float,
) -> int:
    """Append a node unless it is there already or the list is full; return the new count."""
    for i in range(count):
        if nodes[i] == node:
            return count
    if count >= MAX_NODES:
        return count
    nodes[count] = node
    s[count], n[count], ring_weights[count] = s_value, n_value, ring_weight
    return count + 1


@helper
def _apex(rest: Float, face: int, side: int) -> tuple[float, float, float]:
    """Place the corner opposite a side: (length of the side, offset along it from its middle, height)."""
    a, b = (side + 1) % 3, (side + 2) % 3
    ex, ey = rest[face, b, 0] - rest[face, a, 0], rest[face, b, 1] - rest[face, a, 1]
    length = max(sqrt(ex * ex + ey * ey), 1e-300)
    px = rest[face, side, 0] - 0.5 * (rest[face, a, 0] + rest[face, b, 0])
    py = rest[face, side, 1] - 0.5 * (rest[face, a, 1] + rest[face, b, 1])
    height = max(abs(ex * py - ey * px) / length, FLATTEST * length)
    return length, (px * ex + py * ey) / length, height


@helper
def _unfold(
    faces: Int,
    rest: Float,
    face: int,
    side: int,
    placed: Float,
    slot: int,
    near_slot: int,
    near_side: int,
    near_face: int,
) -> None:
    """Place `face` in the hinge's plane, joined by its `side` to the side of an already placed face.

    Middles and directions of the two sides coincide; their lengths may differ (gathers).
    """
    na, nb = (near_side + 1) % 3, (near_side + 2) % 3
    ax, ay = placed[near_slot, na, 0], placed[near_slot, na, 1]
    bx, by = placed[near_slot, nb, 0], placed[near_slot, nb, 1]
    tx, ty = bx - ax, by - ay
    size = max(sqrt(tx * tx + ty * ty), 1e-300)
    tx, ty = tx / size, ty / size
    mx, my = 0.5 * (ax + bx), 0.5 * (ay + by)
    away_x, away_y = -ty, tx
    if (placed[near_slot, near_side, 0] - mx) * away_x + (
        placed[near_slot, near_side, 1] - my
    ) * away_y > 0.0:
        away_x, away_y = ty, -tx
    a, b = (side + 1) % 3, (side + 2) % 3
    if faces[face, a] != faces[near_face, na]:
        tx, ty = -tx, -ty
    length, along, height = _apex(rest, face, side)
    placed[slot, a, 0], placed[slot, a, 1] = mx - 0.5 * length * tx, my - 0.5 * length * ty
    placed[slot, b, 0], placed[slot, b, 1] = mx + 0.5 * length * tx, my + 0.5 * length * ty
    placed[slot, side, 0] = mx + along * tx + height * away_x
    placed[slot, side, 1] = my + along * ty + height * away_y


@helper
def _plane_slope(
    faces: Int, rest: Float, face: int, side: int, sign: float, nodes: Int, weights: Float
) -> None:
    """Fill the slope across a side of the plane through one face, out of it for `sign` = 1."""
    length, along, height = _apex(rest, face, side)
    share = along / length
    nodes[0], weights[0] = faces[face, (side + 1) % 3], sign * (0.5 - share) / height
    nodes[1], weights[1] = faces[face, (side + 2) % 3], sign * (0.5 + share) / height
    nodes[2], weights[2] = faces[face, side], -sign / height


@kernel(types.void(I32_2, F64_3, I32_2, I32_2, BOOL_1, I32_2, OUT_I32_1, OUT_I32_2, OUT_F64_2))
def slope_stencils(
    faces: Int,
    rest: Float,
    neighbours: Int,
    neighbour_sides: Int,
    rigid: Bool,
    sides: Int,
    counts: Int,
    nodes: Int,
    weights: Float,
) -> None:
    """Fill, per side (face, side) in `sides` (h, 2), the nodes and weights of the slope across it.

    The slope is the derivative at the side's middle along the outward normal of `face`, per metre of rest
    length. Faces are unfolded into one plane ring by ring: the two faces of the side, then their neighbours,
    until the nodes determine a quadratic well. A side of a `rigid` face (t,) has the slope of that face's
    plane. `counts` (h,), `nodes` and `weights` (h, MAX_NODES).
    """
    placed = np.empty((MAX_FACES, 3, 2), np.float64)
    members = np.empty(MAX_FACES, np.int32)
    s, n = np.empty(MAX_NODES, np.float64), np.empty(MAX_NODES, np.float64)
    ring_weights = np.empty(MAX_NODES, np.float64)
    basis, matrix = np.empty((MAX_NODES, 6), np.float64), np.empty((6, 6), np.float64)
    residual, update = np.empty(6, np.float64), np.empty(6, np.float64)
    for h in range(len(sides)):
        face, side = sides[h, 0], sides[h, 1]
        across = neighbours[face, side]
        own_nodes, own_weights = nodes[h], weights[h]
        if rigid[face] or (across >= 0 and rigid[across]):
            flat, flat_side, sign = face, side, 1.0
            if not rigid[face]:
                flat, flat_side, sign = across, neighbour_sides[face, side], -1.0
            _plane_slope(faces, rest, flat, flat_side, sign, own_nodes, own_weights)
            counts[h] = 3
            continue
        a, b = (side + 1) % 3, (side + 2) % 3
        length, along, height = _apex(rest, face, side)
        placed[0, a, 0], placed[0, a, 1] = -0.5 * length, 0.0
        placed[0, b, 0], placed[0, b, 1] = 0.5 * length, 0.0
        placed[0, side, 0], placed[0, side, 1] = along, -height
        members[0] = face
        # typed: a literal passed to a helper would be one more specialisation of it
        first, added, member_count, count = np.int64(0), np.int64(0), np.int64(1), np.int64(0)
        half, scale_n = 0.5 * length, height
        if across >= 0:
            other_side = neighbour_sides[face, side]
            _unfold(faces, rest, across, other_side, placed, member_count, first, np.int64(side), face)
            members[1] = across
            member_count += 1
            far_length, _, far_height = _apex(rest, across, other_side)
            half = 0.25 * (length + far_length)
            scale_n = 0.5 * (height + far_height)
        count = _add_node(faces[face, a], -half, 0.0, 1.0, count, own_nodes, s, n, ring_weights)
        count = _add_node(faces[face, b], half, 0.0, 1.0, count, own_nodes, s, n, ring_weights)
        ring, ring_weight, ridge = 0, 1.0, RIDGE
        while True:
            for m in range(added, member_count):
                for c in range(3):
                    node, s_c, n_c = faces[members[m], c], placed[m, c, 0], placed[m, c, 1]
                    count = _add_node(node, s_c, n_c, ring_weight, count, own_nodes, s, n, ring_weights)
            added = member_count
            if ring > 0 and (count >= 6 or ridge == LAST_RIDGE):
                amplification, misfit = _fit(
                    count,
                    s,
                    n,
                    ring_weights,
                    half,
                    scale_n,
                    ridge,
                    basis,
                    matrix,
                    residual,
                    update,
                    own_weights,
                )
                if ridge == LAST_RIDGE or (amplification < AMPLIFICATION_LIMIT and misfit < EXACTNESS):
                    break
            last = member_count
            for m in range(first, last):
                for k in range(3):
                    other = neighbours[members[m], k]
                    # curvature jumps where a clamp ends: nodes behind it say nothing about the cloth
                    if other < 0 or rigid[other] or member_count >= MAX_FACES:
                        continue
                    known = False
                    for q in range(member_count):
                        known = known or members[q] == other
                    if not known:
                        other_side = neighbour_sides[members[m], k]
                        _unfold(faces, rest, other, other_side, placed, member_count, m, k, members[m])
                        members[member_count] = other
                        member_count += 1
            first = last
            ring += 1
            ring_weight *= RING_WEIGHT
            if ring > MAX_RINGS or member_count == last:
                ridge = LAST_RIDGE
        counts[h] = count
