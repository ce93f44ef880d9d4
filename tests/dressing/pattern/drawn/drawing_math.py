"""Exact areas of drawings of Bezier curves, by Green's theorem, independent of the readers."""

import math
import re
from itertools import pairwise
from pathlib import Path

import numpy as np

from toile.geometry.arrays import Float


def bezier_area(curves: list[Float]) -> float:
    """Area enclosed by cubic and straight sides, each control points of shape (4, 2) or (2, 2)."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    t, w = (nodes + 1) / 2, weights / 2
    total = 0.0
    for control in curves:
        if len(control) == 2:
            (x0, y0), (x1, y1) = control
            total += 0.5 * (x0 * y1 - x1 * y0)
            continue
        basis = np.column_stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
        slope = 3 * np.column_stack([(1 - t) ** 2, 2 * t * (1 - t), t**2]) @ np.diff(control, axis=0)
        on = basis @ control
        total += 0.5 * float(w @ (on[:, 0] * slope[:, 1] - on[:, 1] * slope[:, 0]))
    return abs(total)


def fabric_area(svg: Path, part: str) -> float:
    """Area [m^2] of the first path of class "fabric" of a part of a FreeSewing SVG."""
    text = svg.read_text()
    group = text[re.search(rf'-part-\w+\.{part}"', text).end() :]  # type: ignore[union-attr]
    d = re.search(r'<path\s+class="fabric"[^>]*?\sd="([^"]+)"', group) or re.search(
        r'class="fabric"\s[^>]*d="([^"]+)"', group
    )
    assert d is not None
    tokens = re.findall(r"[MLCz]|-?[\d.]+(?:e-?\d+)?", d[1])
    curves: list[Float] = []
    start = here = np.zeros(2)
    kind, index = "", 0
    while index < len(tokens):
        if tokens[index].isalpha():
            kind, index = tokens[index], index + 1
            continue
        count = {"M": 2, "L": 2, "C": 6}[kind]
        numbers = np.array(list(map(float, tokens[index : index + count]))).reshape(-1, 2)
        if kind == "M":
            start = numbers[0]
        else:
            curves.append(np.vstack([here[None], numbers]))
        here, index = numbers[-1], index + count
    curves.append(np.vstack([here, start]))
    return 1e-6 * bezier_area(curves)


def _spline(
    a: tuple[float, float], b: tuple[float, float], angles: tuple[float, float], lengths: tuple[float, float]
) -> Float:
    """A spline of Valentina: control points by angle, counter-clockwise with y down, and length."""
    control = [
        (x + length * math.cos(math.radians(angle)), y - length * math.sin(math.radians(angle)))
        for (x, y), angle, length in zip((a, b), angles, lengths, strict=True)
    ]
    return np.array([a, *control, b])


def _line(*points: tuple[float, float]) -> list[Float]:
    return [np.array([a, b]) for a, b in pairwise(points)]


OWN_TEE: dict[str, list[Float]] = {
    "FRONT": [
        _spline((0, 9), (8, 0), (0, 260), (4.5, 4.5)), *_line((8, 0), (20, 4)),
        _spline((20, 4), (18.5, 14), (250, 80), (3.5, 3.5)),
        _spline((18.5, 14), (25, 23), (280, 180), (4, 4)),
        *_line((25, 23), (25, 60), (0, 60), (0, 9)),
    ],
    "BACK": [
        _spline((40, 2.5), (48, 0), (0, 215), (4.5, 2)), *_line((48, 0), (60, 4)),
        _spline((60, 4), (59.2, 14), (255, 85), (3.5, 3.5)),
        _spline((59.2, 14), (65, 23), (275, 180), (4, 3.6)),
        *_line((65, 23), (65, 60), (40, 60), (40, 2.5)),
    ],
    "SLEEVE": [
        _spline((80, 14), (98, 0), (10, 180), (7, 7)), _spline((98, 0), (116, 14), (0, 170), (7, 7)),
        *_line((116, 14), (113, 30), (83, 30), (80, 14)),
    ],
}  # fmt: skip
"""Sides of the pieces as own_tee.val draws them [cm], y down."""
