"""What happens at the corners between warp and weft: shear, and yarns that touch their neighbours.

With e_1, e_2 the pieces of warp and weft that meet in a corner, d_1, d_2 their directions, G the stiffness
against shear and k_x = G p_u p_v / 4, shear stores

    E = k_x gamma^2 / 2,  sin gamma = d_1 . d_2

and with y the distance of the neighbouring yarn, which passes the end of e_2, from the line of e_1, and b the
width of a yarn, yarns pressed together side by side store

    E = k_c p/4 max(b - y, 0)^2

for warp and weft alike. The same term locks shear and keeps yarns apart that slide together.
"""

import numpy as np

from toile.engine.swatch.net import WARP, WEFT, Net
from toile.engine.swatch.terms import Terms, across, without_negative
from toile.geometry.arrays import Float

STEEPEST = 0.999999
"""Largest sine of the shear angle."""


def shear_terms(net: Net, state: Float) -> Terms:
    """Return the shear of all corners; the numbers of an element are its two pieces e_1 and e_2."""
    _, length, direction = _arms(net, state)
    sine = np.clip((direction[0] * direction[1]).sum(axis=1), -STEEPEST, STEEPEST)
    angle, cosine = np.arcsin(sine), np.sqrt(1.0 - sine * sine)
    stiffness = 0.25 * net.shear * net.strands[WARP].spacing * net.strands[WEFT].spacing
    turn = [across(direction[k], length[k]) for k in (0, 1)]
    by_arm = np.concatenate([np.einsum("eij,ej->ei", turn[k], direction[1 - k]) for k in (0, 1)], axis=1)
    by_sine = stiffness * angle / cosine
    hessian = (stiffness * (1.0 + angle * sine / cosine) / cosine**2)[:, None, None] * (
        by_arm[:, :, None] * by_arm[:, None, :]
    )
    hessian += by_sine[:, None, None] * _bent_sine(length, direction, turn, by_arm, sine)
    jacobian = np.tile(np.kron(np.array([[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]]), np.eye(3)), (len(sine), 1, 1))
    return Terms(
        net.corners,
        0.5 * stiffness * angle**2,
        jacobian,
        by_sine[:, None] * by_arm,
        without_negative(hessian),
    )


def _bent_sine(
    length: list[Float], direction: list[Float], turn: list[Float], by_arm: Float, sine: Float
) -> Float:
    """Return the second derivatives of sin gamma by both pieces, shape (C, 6, 6)."""
    bent = np.empty((len(sine), 6, 6))
    for k in (0, 1):
        own = slice(3 * k, 3 * k + 3)
        mixed = direction[k][:, :, None] * by_arm[:, None, own] / length[k][:, None, None]
        bent[:, own, own] = -mixed - mixed.transpose(0, 2, 1) - (sine / length[k])[:, None, None] * turn[k]
    bent[:, :3, 3:] = turn[0] @ turn[1]
    bent[:, 3:, :3] = bent[:, :3, 3:].transpose(0, 2, 1)
    return bent


def touch_terms(net: Net, state: Float) -> list[Terms]:
    """Return yarns that touch their neighbours: of the warp, of the weft. The number of an element is y."""
    e, length, direction = _arms(net, state)
    found = []
    for axis in (WARP, WEFT):
        strand = net.strands[axis]
        line, arm = direction[axis], e[1 - axis]
        along = (arm * line).sum(axis=1)
        off = arm - along[:, None] * line
        distance = np.maximum(np.sqrt((off * off).sum(axis=1)), 1e-3 * strand.width)
        near = np.flatnonzero(distance < strand.width).astype(np.int32)
        gap, off, along = strand.width - distance[near], off[near] / distance[near, None], along[near]
        by_line = -np.einsum("eij,ej->ei", across(line[near], length[axis][near]), off) * along[:, None]
        by_arm = [by_line, off] if axis == WARP else [off, by_line]
        stiffness = 0.5 * net.squeeze * strand.spacing
        found.append(
            Terms(
                net.corners[near], 0.5 * stiffness * gap**2, _jacobian(by_arm), -stiffness * gap[:, None],
                np.full((len(near), 1, 1), stiffness), rows=near,
            )
        )  # fmt: skip
    return found


def _arms(net: Net, state: Float) -> tuple[list[Float], list[Float], list[Float]]:
    """Return the pieces that meet in every corner, their lengths and directions."""
    centre = state[net.corners[:, 0]]
    e = [state[net.corners[:, 1 + axis]] - centre for axis in (WARP, WEFT)]
    length = [np.sqrt((arm * arm).sum(axis=1)) for arm in e]
    return e, length, [arm / size[:, None] for arm, size in zip(e, length, strict=True)]


def _jacobian(by_arm: list[Float]) -> Float:
    """Return derivatives by the three nodes of a corner from those by its arms, shape (E, 1, 9)."""
    return np.concatenate([-by_arm[0] - by_arm[1], by_arm[0], by_arm[1]], axis=1)[:, None, :]
