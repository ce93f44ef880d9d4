"""The built-in mannequin in motion: it walks from a standing start, or turns about on the spot."""

import numpy as np

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.mannequin_figure import ARM_ANGLE, CROTCH, SHOULDER
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Float

FPS = 24.0
STRIDE_SECONDS, SPEED = 1.1, 1.1
"""Time of two steps [s], and how fast it walks [m/s]."""
LEG_SWING, ARM_SWING, ARM_LOWERED = np.radians((24.0, 18.0, 22.0))
"""Largest swing of legs and arms, and how far arms are let down, all [rad]."""
STARTING = 0.5
"""Time after which it walks at full swing [s]."""
TURN, TURN_SECONDS = np.pi, 0.8
"""How far it turns about the vertical [rad], and in what time [s]."""
HIP = 0.53
"""Level of the hip joints, in heights."""


def walk(body: Avatar, frames: int) -> VertexMotion:
    """Return `frames` frames of a mannequin of `dress.mannequin` that walks along +z.

    Its skin follows smooth weights of two hip and two shoulder joints, without knees or elbows: a body for
    tests of cloth, not for the eye.
    """
    poses = np.stack([_pose(body.vertices, index / FPS) for index in range(frames)])
    return VertexMotion(frames=poses, fps=FPS)


def in_a_loop(body: Avatar, frames: int) -> VertexMotion:
    """Return `frames` frames of a mannequin that walks on the spot; in single precision, as may be many."""
    poses = np.empty((frames, *body.vertices.shape), np.float32)
    for index in range(frames):
        poses[index] = _pose(body.vertices, index / FPS) - (0.0, 0.0, _walked(index / FPS))
    return VertexMotion(frames=poses, fps=FPS)


def turn(body: Avatar, frames: int) -> VertexMotion:
    """Return `frames` frames of a body that turns half around to its left, stiffly, and then stands."""
    poses = [
        _turned(body.vertices, np.full(len(body.vertices), TURN * _eased(index / FPS / TURN_SECONDS)), axis=1)
        for index in range(frames)
    ]
    return VertexMotion(frames=np.stack(poses), fps=FPS)


def _pose(vertices: Float, seconds: float) -> Float:
    """Vertices [m], shape (v, 3), at a time."""
    height = float(vertices[:, 1].max())
    begun = float(_eased(seconds / STARTING))
    swing = begun * np.sin(2.0 * np.pi * seconds / STRIDE_SECONDS)
    x, y = vertices[:, 0] / height, vertices[:, 1] / height
    side = np.sign(x)
    # Place along and across the straight arm, as the figure is drafted.
    cosine, sine = np.cos(ARM_ANGLE), np.sin(ARM_ANGLE)
    along = (np.abs(x) - SHOULDER[0]) * cosine - (y - SHOULDER[1]) * sine
    across = (np.abs(x) - SHOULDER[0]) * sine + (y - SHOULDER[1]) * cosine
    arm = _eased((along + 0.03) / 0.08) * _eased((across + 0.075) / 0.045)
    leg = _eased((HIP - y) / 0.09) * np.clip(x / 0.02, -1.0, 1.0) * (arm == 0.0)

    posed = vertices.copy()
    shoulder = np.column_stack(
        (side * SHOULDER[0] * height, np.full_like(x, SHOULDER[1] * height), np.zeros_like(x))
    )
    posed = shoulder + _turned(posed - shoulder, -side * arm * begun * ARM_LOWERED, axis=2)
    posed = shoulder + _turned(posed - shoulder, side * arm * ARM_SWING * swing, axis=0)
    hip = np.array([0.0, HIP * height, 0.0])
    posed = hip + _turned(posed - hip, -leg * LEG_SWING * swing, axis=0)
    # The trunk sinks as the legs part.
    sunk = CROTCH * height * (1.0 - np.cos(LEG_SWING * swing))
    return np.asarray(posed + np.array([0.0, -sunk, _walked(seconds)]))


def _walked(seconds: float) -> float:
    """How far it has come at a time [m]."""
    return SPEED * (max(seconds - STARTING, 0.0) + 0.5 * min(seconds, STARTING) ** 2 / STARTING)


def _turned(points: Float, angle: Float, axis: int) -> Float:
    """Turn points, shape (n, 3), each by its own angle [rad] about a coordinate axis through the origin."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turned = points.copy()
    turned[:, first] = np.cos(angle) * points[:, first] - np.sin(angle) * points[:, second]
    turned[:, second] = np.sin(angle) * points[:, first] + np.cos(angle) * points[:, second]
    return turned


def _eased(share: Float | float) -> Float:
    """Smooth step from 0 at share 0 to 1 at share 1."""
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(s * s * (3.0 - 2.0 * s))
