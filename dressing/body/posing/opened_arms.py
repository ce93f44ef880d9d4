"""A made pose with open arms, and the way from there, for bodies whose arms hang or touch them.

The centre line of an arm is straightened and turned to the side: every ring turns by the smallest rotation
that takes the line there, and a share of it leads back. The skin around the shoulder follows in part.
"""

import numpy as np
from scipy.sparse import coo_array, csr_array

from toile.dressing.body.avatar_crossings import crossing_pairs
from toile.dressing.body.posing.limb import Limb, arms_of
from toile.geometry.arrays import Bool, Float, Int

DOWN = np.radians(42.0)
"""How far below the horizontal open arms point [rad]."""
AROUND_SHOULDER = (0.03, 0.06)
"""Skin that follows in part, on the arm and on the trunk, in body heights."""
JOINT = 0.03
"""How far the joint of the shoulder lies above the armpit, in body heights."""
CREASE = 2
"""Rings of vertices around a crease that are smoothed with it."""
SMOOTHINGS = 16
"""Rounds of smoothing at most, of SWEEPS sweeps each."""
SWEEPS = 3
BEND = 3
"""Rings on either side over which the direction of an arm is averaged: elbows bend over a length."""


def opened_arms(vertices: Float, faces: Int, shares: Float) -> Float | None:
    """Return a body with its arms opened by shares of the way, or None if its arms are not found.

    Parameters
    ----------
    vertices, faces
        The body in its own frame [m], shape (v, 3), and its faces, shape (f, 3).
    shares
        0 leaves the arms as they are, 1 opens them to the sides, shape (k,).

    Returns
    -------
    ndarray
        Vertices [m], shape (k, v, 3).
    """
    arms = arms_of(vertices, faces)
    if arms is None:
        return None
    sides = [float(np.sign(arm.centres[0, 0])) for arm in arms]
    if sorted(sides) != [-1.0, 1.0]:
        return None
    height = float(np.ptp(vertices[:, 1]))
    every = np.concatenate([shares, [1.0]])
    frames = np.repeat(vertices[None], len(every), axis=0)
    moved = np.zeros(len(vertices), bool)
    for arm, side in zip(arms, sides, strict=True):
        _open(frames, vertices, arm, side, height, every)
        moved |= arm.distance < arm.levels[0] + AROUND_SHOULDER[1] * height
    uncreased = _uncreased(frames[-1], faces, moved) - frames[-1]
    return np.asarray(frames[:-1] + shares[:, None, None] * uncreased)


def _open(frames: Float, vertices: Float, arm: Limb, side: float, height: float, shares: Float) -> None:
    """Move the vertices of one arm in every frame, (k, v, 3)."""
    on_arm, on_trunk = (width * height for width in AROUND_SHOULDER)
    levels, centres = arm.levels, arm.centres
    turns = _turns(centres, np.array([side * np.cos(DOWN), -np.sin(DOWN), 0.0]))
    upper = centres[BEND] - centres[0]
    joint = centres[0] - JOINT * height * upper / np.linalg.norm(upper)
    moved = np.flatnonzero(arm.distance < levels[0] + on_trunk)
    distance = arm.distance[moved]
    # Place of every vertex among the rings; the hand goes with the wrist, the trunk with the first ring.
    place = np.interp(-distance, -levels, np.arange(len(levels), dtype=np.float64))
    low = np.minimum(place.astype(np.int64), len(levels) - 2)
    part = (place - low)[:, None]

    def between(values: Float) -> Float:
        return np.asarray((1.0 - part) * values[low] + part * values[low + 1])

    own, away = between(turns), vertices[moved] - between(centres)
    # Skin around the joint is turned back in part, all the way where the trunk begins.
    back = (_eased((distance - levels[0] + on_arm) / (on_arm + on_trunk)))[:, None] * turns[0]
    steps = np.diff(centres, axis=0)
    for frame, share in zip(frames, shares, strict=True):
        if share == 0.0:
            continue
        first = joint + _rotated(share * turns[:1], centres[:1] - joint)
        turned = _rotated(share * 0.5 * (turns[1:] + turns[:-1]), steps)
        line = np.concatenate([first, first + np.cumsum(turned, axis=0)])
        stiff = between(line) + _rotated(share * own, away)
        frame[moved] = joint + _rotated(-share * back, stiff - joint)


def _uncreased(opened: Float, faces: Int, moved: Bool) -> Float:
    """Vertices, shape (v, 3), smoothed where skin that moved, (v,), crosses itself, as in a folded armpit."""
    own = faces[moved[faces].any(axis=1)]
    a, b = own.ravel(), own[:, [1, 2, 0]].ravel()
    linked = csr_array(coo_array((np.ones(len(a)), (a, b)), shape=(len(opened),) * 2))
    mean: csr_array = csr_array(linked.multiply(1.0 / np.maximum(linked.sum(axis=1), 1.0)[:, None]))
    smooth = opened.copy()
    region = np.zeros(len(opened), bool)
    for _ in range(SMOOTHINGS):
        pairs = crossing_pairs(smooth, own)
        if not len(pairs):
            break
        crease = np.zeros(len(opened))
        crease[own[pairs].ravel()] = 1.0
        for _ in range(CREASE):
            crease = np.maximum(crease, np.asarray(linked @ crease > 0.0, np.float64))
        region |= (crease > 0.0) & moved
        for _ in range(SWEEPS):
            smooth[region] = (mean @ smooth)[region]
    return smooth


def _turns(centres: Float, towards: Float) -> Float:
    """Rotation vectors that turn the line through centres, (r, 3), to a direction, shape (r, 3)."""
    steps = np.diff(centres, axis=0)
    steps = np.concatenate([steps[:1], steps])
    count = len(steps)
    along = np.stack([steps[max(k - BEND, 0) : min(k + BEND + 1, count)].sum(axis=0) for k in range(count)])
    along /= np.linalg.norm(along, axis=1)[:, None]
    axis = np.cross(along, towards)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, along @ towards)
    return np.asarray(axis * (angle / np.maximum(sine, 1e-12))[:, None])


def _rotated(turns: Float, vectors: Float) -> Float:
    """Vectors turned by rotation vectors [rad], both shape (n, 3) (Rodrigues)."""
    angle = np.linalg.norm(turns, axis=1)
    axis = turns / np.maximum(angle, 1e-12)[:, None]
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    along = np.einsum("ni,ni->n", axis, vectors)[:, None]
    return np.asarray(cosine * vectors + sine * np.cross(axis, vectors) + (1.0 - cosine) * along * axis)


def _eased(share: Float) -> Float:
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(s * s * (3.0 - 2.0 * s))
