"""Paths of SVG as points."""

import re
from itertools import pairwise

import numpy as np

from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

CURVE_SEGMENTS = 48
"""Sides that stand for one Bezier curve."""
_TOKEN = re.compile(r"[A-Za-z]|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_COUNT = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "Q": 4, "Z": 0}


def flat_path(d: str, where: str) -> Float:
    """Return the points of the first subpath of a path, curves spaced evenly in length, shape (n, 2).

    Raises InputError, beginning with `where`, for commands other than M, L, H, V, C, Q and Z and for
    coordinates that are not finite.
    """
    tokens = _TOKEN.findall(d)
    points: list[Float] = []
    index, command = 0, ""
    while index < len(tokens):
        if tokens[index].isalpha():
            command, index = tokens[index], index + 1
        kind = command.upper()
        if kind not in _COUNT:
            raise InputError(f"{where}: path command '{command}' is not known; use lines and Bezier curves")
        if kind == "Z" or (kind == "M" and points):
            break
        try:
            numbers = [float(token) for token in tokens[index : index + _COUNT[kind]]]
        except ValueError:
            numbers = []
        if len(numbers) != _COUNT[kind]:
            raise InputError(f"{where}: path command '{command}' lacks numbers; save the drawing again")
        index += _COUNT[kind]
        here = points[-1] if points else np.zeros(2)
        _go(points, kind, numbers, here, relative=command.islower())
        command = {"M": "L", "m": "l"}.get(command, command)
    drawn = np.array(points).reshape(-1, 2)
    if not np.isfinite(drawn).all():
        raise InputError(f"{where}: a path has a coordinate that is not finite; save the drawing again")
    return drawn


def _go(points: list[Float], kind: str, numbers: list[float], here: Float, *, relative: bool) -> None:
    """Append what one command draws."""
    base = here if relative else np.zeros(2)
    if kind in "HV":
        axis = "HV".index(kind)
        point = here.copy()
        point[axis] = base[axis] + numbers[0]
        points.append(point)
        return
    control = np.array(numbers).reshape(-1, 2) + base
    if kind in "ML":
        points.append(control[0])
        return
    control = np.vstack([here[None], control])
    t = np.linspace(0.0, 1.0, 8 * CURVE_SEGMENTS + 1)[:, None]
    level = [np.broadcast_to(point, (len(t), 2)) for point in control]
    while len(level) > 1:
        level = [(1.0 - t) * a + t * b for a, b in pairwise(level)]
    walked = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(level[0], axis=0), axis=1))])
    if walked[-1] == 0.0:
        return
    # Even in length: where control points coincide with ends, even parameters would crowd points there.
    at = np.linspace(0.0, walked[-1], CURVE_SEGMENTS + 1)[1:]
    points += list(np.column_stack([np.interp(at, walked, level[0][:, axis]) for axis in (0, 1)]))
    points[-1] = control[-1]
