"""One round of flips: the edges that flip at once, and the faces and edges that result."""

from numba import types

from toile.geometry.kernel import F64_1, I32_1, I32_2, I64_1, OUT_BOOL_1, OUT_I32_1, OUT_I32_2, helper, kernel
from toile.remesh.mesh.sorted_keys import is_among, pair_key


@kernel(
    types.int64(
        I64_1, F64_1, I32_2, I32_1, I32_2, I32_2, I32_1, I64_1, I64_1, OUT_BOOL_1, OUT_I32_1, OUT_I32_2,
        OUT_I32_1,
    )
)  # fmt: skip
def choose_flips(  # type: ignore[no-untyped-def]
    order, excess, quads, active, nodes, at_faces, node, keys, refused, used, last, chain, taken
):
    """Write the rows of `active` that flip at once, in `order`; returns how many.

    They share no face, make an edge that is not there yet (`keys`) nor made by another, and have not been
    `refused`. Work space: `used` (t,), all False, `last` (n,), all -1, and `chain` (k, 2).
    """
    count, made = 0, 0
    for row in order:
        if not excess[row] > -1e300:
            break
        edge = active[row]
        a, d = node[quads[row, 0]], node[quads[row, 3]]
        if a == d or is_among(keys, pair_key(a, d)):
            continue
        if is_among(refused, pair_key(nodes[edge, 0], nodes[edge, 1])):
            continue
        t, u = at_faces[edge, 0], at_faces[edge, 1]
        if used[t] or used[u]:
            continue
        used[t] = True
        used[u] = True
        # New edges by their lower node, each with the one that came before it there.
        low, high = min(a, d), max(a, d)
        link = last[low]
        while link >= 0 and chain[link, 0] != high:
            link = chain[link, 1]
        if link >= 0:
            continue
        chain[made, 0], chain[made, 1] = high, last[low]
        last[low] = made
        made += 1
        taken[count] = row
        count += 1
    return count


@helper
def _move(at_faces, sides, edge, old, new, side):  # type: ignore[no-untyped-def]
    """Let an edge that lies at face `old` lie at a side of face `new` instead."""
    for slot in range(2):
        if at_faces[edge, slot] == old:
            at_faces[edge, slot] = new
            sides[edge, slot] = side


@kernel(types.void(I32_1, I32_2, I32_1, OUT_I32_2, OUT_I32_2, OUT_I32_2, OUT_I32_2, OUT_I32_2))
def turn_edges(flipping, quads, node, faces, nodes, at_faces, sides, face_edges):  # type: ignore[no-untyped-def]
    """Replace faces abc, dcb at the edges `flipping` by abd, adc; `quads` (k, 4) are their a, b, c, d."""
    for row in range(len(flipping)):
        edge = flipping[row]
        a, b, c, d = quads[row, 0], quads[row, 1], quads[row, 2], quads[row, 3]
        t, u = at_faces[edge, 0], at_faces[edge, 1]
        k, j = sides[edge, 0], sides[edge, 1]
        ca, ab = face_edges[t, (k + 1) % 3], face_edges[t, (k + 2) % 3]
        bd, dc = face_edges[u, (j + 1) % 3], face_edges[u, (j + 2) % 3]
        _move(at_faces, sides, bd, u, t, 0)
        _move(at_faces, sides, ab, t, t, 2)
        _move(at_faces, sides, dc, u, u, 0)
        _move(at_faces, sides, ca, t, u, 1)
        at_faces[edge, 0], at_faces[edge, 1] = t, u
        sides[edge, 0], sides[edge, 1] = 1, 2
        face_edges[t, 0], face_edges[t, 1], face_edges[t, 2] = bd, edge, ab
        face_edges[u, 0], face_edges[u, 1], face_edges[u, 2] = dc, ca, edge
        nodes[edge, 0], nodes[edge, 1] = min(node[a], node[d]), max(node[a], node[d])
        faces[t, 0], faces[t, 1], faces[t, 2] = a, b, d
        faces[u, 0], faces[u, 1], faces[u, 2] = a, d, c
