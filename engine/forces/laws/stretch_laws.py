"""Energy of stretch with curves of tension, coupled between warp and weft.

With e_u = |f_u| - 1 and e_v alike, taut cloth has the energy per rest area

    psi = F_u(e_u) + F_v(e_v) + c e_u e_v.

F_u and F_v are such that cloth pulled along one thread and free along the other has the tension of its curve,
T: F'(e) = T(e) + nu^2 / (1 - nu^2) T'(0) e and c = nu / (1 - nu^2) sqrt(T_u'(0) T_v'(0)), with nu the
geometric mean of both Poisson's ratios. The share (1 - compression) of the energy is relaxed (Pipkin 1986):
where psi would press along a thread, that thread gathers until nothing presses, and the cloth is pulled along
the other alone or slack. Both parts have continuous first derivatives, and are convex where the slopes of the
curves never fall below nu/(1 + nu) times the first.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np
from numba import types

from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fabric_curves import curve_tables, has_law
from toile.geometry.arrays import Float, Int
from toile.geometry.kernel import F64_2, I32_2, OUT_F64_1, OUT_F64_3, OUT_F64_4, helper, kernel


class StretchLaws(NamedTuple):
    """Curves of the faces that have any.

    Attributes
    ----------
    laws
        Which faces those are, and the row of `spans` of each, shape (l, 2).
    table
        Pieces of all curves: see `stretch_curve`, shape (r, 6).
    spans
        First and last row in `table` of the curve along warp, then along weft, of every law, shape (k, 4).
    shares
        Of every face (l,): factors on its curves along warp and weft, nu, compression: shape (l, 4).
    """

    laws: Int
    table: Float
    spans: Int
    shares: Float


def stretch_laws(
    fabrics: tuple[Fabric, ...], fabric: Int, stretch_warp: Float, stretch_weft: Float, compression: Float
) -> StretchLaws | None:
    """Return the laws of faces of fabrics, shape (t,), or None where none has any.

    Where the stiffness of a face [N/m], shape (t,), is not that of its fabric, its curve is scaled alike.
    """
    number = np.full(len(fabrics), -1, np.int32)
    spans, tables, first = list[list[int]](), list[Float](), 0
    for index, some in enumerate(fabrics):
        if has_law(some):
            number[index] = len(spans)
            span = list[int]()
            for table in curve_tables(some):
                span += [first, first + len(table) - 1]
                tables.append(table)
                first += len(table)
            spans.append(span)
    if not spans:
        return None
    faces = np.flatnonzero(number[fabric] >= 0).astype(np.int32)
    kind = fabric[faces]
    warp, weft, poisson = np.array([(f.stretch_warp, f.stretch_weft, f.poisson) for f in fabrics]).T
    shares = np.column_stack(
        (
            stretch_warp[faces] / warp[kind],
            stretch_weft[faces] / weft[kind],
            poisson[kind],
            compression[faces],
        )
    )
    return StretchLaws(
        np.column_stack((faces, number[kind])), np.ascontiguousarray(np.concatenate(tables)),
        np.array(spans, np.int32), np.ascontiguousarray(shares),
    )  # fmt: skip


@helper
def _on_curve(table, first, last, e):  # type: ignore[no-untyped-def]
    """Return energy, tension and slope of a curve at strain e."""
    row = first
    while row < last and e >= table[row + 1, 0]:
        row += 1
    s = e - table[row, 0]
    if e < 0.0:
        return 0.5 * table[row, 3] * e * e, table[row, 3] * e, table[row, 3]
    c, d, g = table[row, 3], table[row, 4], table[row, 5]
    energy = table[row, 1] + s * (table[row, 2] + s * (0.5 * c + s * (d / 3.0 + 0.25 * s * g)))
    return energy, table[row, 2] + s * (c + s * (d + s * g)), c + s * (2.0 * d + 3.0 * s * g)


@helper
def _response(table, spans, k, warp, weft, nu, compression, e_u, e_v):  # type: ignore[no-untyped-def]
    """Return energy, tensions along warp and weft, and second derivatives uu, vv, uv per rest area."""
    w_u, t_u, k_u = _on_curve(table, spans[k, 0], spans[k, 1], e_u)
    w_v, t_v, k_v = _on_curve(table, spans[k, 2], spans[k, 3], e_v)
    w_u, t_u, k_u = warp * w_u, warp * t_u, warp * k_u
    w_v, t_v, k_v = weft * w_v, weft * t_v, weft * k_v
    first_u, first_v = warp * table[spans[k, 0], 3], weft * table[spans[k, 2], 3]
    more = nu * nu / (1.0 - nu * nu)
    c = nu / (1.0 - nu * nu) * sqrt(first_u * first_v)
    energy = w_u + w_v + 0.5 * more * (first_u * e_u * e_u + first_v * e_v * e_v) + c * e_u * e_v
    pull_u, pull_v = t_u + more * first_u * e_u + c * e_v, t_v + more * first_v * e_v + c * e_u
    uu, vv, uv = k_u + more * first_u, k_v + more * first_v, c
    if pull_u > 0.0 and pull_v > 0.0:
        return energy, pull_u, pull_v, uu, vv, uv
    energy, uu, vv, uv = compression * energy, compression * uu, compression * vv, compression * uv
    pull_u, pull_v = compression * pull_u, compression * pull_v
    relaxed = 1.0 - compression
    if e_u > 0.0 and pull_v <= 0.0:
        energy, pull_u, uu = energy + relaxed * w_u, pull_u + relaxed * t_u, uu + relaxed * k_u
    elif e_v > 0.0 and pull_u <= 0.0:
        energy, pull_v, vv = energy + relaxed * w_v, pull_v + relaxed * t_v, vv + relaxed * k_v
    return energy, pull_u, pull_v, uu, vv, uv


@helper
def _of_face(laws, table, spans, shares, shape, faces, x, row, f):  # type: ignore[no-untyped-def]
    """Fill f_u and f_v (2, 3) of a face; return their lengths and the response per rest area."""
    t, k = laws[row, 0], laws[row, 1]
    for c in range(3):
        f[0, c] = f[1, c] = 0.0
        for a in range(3):
            f[0, c] += shape[t, 4 + a] * x[faces[t, a], c]
            f[1, c] += shape[t, 7 + a] * x[faces[t, a], c]
    length_u = sqrt(f[0, 0] * f[0, 0] + f[0, 1] * f[0, 1] + f[0, 2] * f[0, 2])
    length_v = sqrt(f[1, 0] * f[1, 0] + f[1, 1] * f[1, 1] + f[1, 2] * f[1, 2])
    energy, pull_u, pull_v, uu, vv, uv = _response(
        table, spans, k, shares[row, 0], shares[row, 1], shares[row, 2], shares[row, 3],
        length_u - 1.0, length_v - 1.0,
    )  # fmt: skip
    return length_u, length_v, energy, pull_u, pull_v, uu, vv, uv


@kernel(types.void(I32_2, F64_2, I32_2, F64_2, F64_2, I32_2, F64_2, OUT_F64_1))
def add_stretch_energies(laws, table, spans, shares, shape, faces, x, energy):  # type: ignore[no-untyped-def]
    """Add energies [J] to those of faces (t,); `laws` (l, 2) are faces and their laws."""
    f = np.empty((2, 3), np.float64)
    for row in range(len(laws)):
        found = _of_face(laws, table, spans, shares, shape, faces, x, row, f)
        energy[laws[row, 0]] += shape[laws[row, 0], 0] * found[2]


@kernel(types.void(I32_2, F64_2, I32_2, F64_2, F64_2, I32_2, F64_2, OUT_F64_1, OUT_F64_3, OUT_F64_4))
def add_stretch(  # type: ignore[no-untyped-def]
    laws, table, spans, shares, shape, faces, x, energy, gradient, hessian
):
    """Add energies [J] (t,), gradients [N] (t, 3, 3) and, if `hessian` has rows, blocks [N/m] (t, 6, 3, 3).

    In (f_u, f_v) the Hessian is K_ij n_i n_j^T, with K the second derivatives in (e_u, e_v) and n the unit
    vectors along f, plus tension/|f| across f. K is projected on its positive part, and tension taken where
    it is positive.
    """
    f = np.empty((2, 3), np.float64)
    n = np.empty((2, 3), np.float64)
    for row in range(len(laws)):
        t = laws[row, 0]
        length_u, length_v, density, pull_u, pull_v, uu, vv, uv = _of_face(
            laws, table, spans, shares, shape, faces, x, row, f
        )
        area = shape[t, 0]
        energy[t] += area * density
        inverse_u = 1.0 / length_u if length_u > 0.0 else 0.0
        inverse_v = 1.0 / length_v if length_v > 0.0 else 0.0
        for c in range(3):
            n[0, c], n[1, c] = inverse_u * f[0, c], inverse_v * f[1, c]
        for a in range(3):
            of_u, of_v = shape[t, 4 + a] * area * pull_u, shape[t, 7 + a] * area * pull_v
            for c in range(3):
                gradient[t, a, c] += of_u * n[0, c] + of_v * n[1, c]
        if len(hessian) == 0:
            continue
        # the positive part of [[uu, uv], [uv, vv]]
        middle, half = 0.5 * (uu + vv), 0.5 * (uu - vv)
        spread = sqrt(half * half + uv * uv)
        low, high = middle - spread, middle + spread
        if low < 0.0:
            if high <= 0.0:
                uu = vv = uv = 0.0
            else:
                share = high / (2.0 * spread)
                uu, vv, uv = share * (spread + half), share * (spread - half), share * uv
        across_u, across_v = max(0.0, pull_u) * inverse_u, max(0.0, pull_v) * inverse_v
        for pair in range(6):
            a = pair if pair < 3 else (0 if pair < 5 else 1)
            b = pair if pair < 3 else (1 if pair == 3 else 2)
            w_u, w_v = area * shape[t, 4 + a] * shape[t, 4 + b], area * shape[t, 7 + a] * shape[t, 7 + b]
            w_uv = area * uv * shape[t, 4 + a] * shape[t, 7 + b]
            w_vu = area * uv * shape[t, 7 + a] * shape[t, 4 + b]
            for r in range(3):
                for c in range(3):
                    unit = 1.0 if r == c else 0.0
                    hessian[t, pair, r, c] += (
                        w_u * ((uu - across_u) * n[0, r] * n[0, c] + across_u * unit)
                        + w_v * ((vv - across_v) * n[1, r] * n[1, c] + across_v * unit)
                        + w_uv * n[0, r] * n[1, c]
                        + w_vu * n[1, r] * n[0, c]
                    )
