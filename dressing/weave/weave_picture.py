"""A picture of a weave: from above, cut along both yarns, and its tensile curves, as SVG."""

import math
from itertools import pairwise

import numpy as np

from toile.dressing.weave.crossing import System
from toile.dressing.weave.woven import TENSIONS, Woven

WIDTH, HEIGHT, MARGIN = 960, 400, 48
WARP, WEFT, INK = "#2f6f9f", "#c4773a", "#333333"
CROSSINGS = 8
"""Crossings that are shown along each side."""


def weave_svg(cloth: Woven) -> str:
    """Return the picture as SVG."""
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
        f'font-size="13" fill="{INK}">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        *_from_above(cloth), *_cuts(cloth), *_curves(cloth), "</svg>",
    ]  # fmt: skip
    return "\n".join(parts) + "\n"


def _from_above(cloth: Woven) -> list[str]:
    """Draw the weave from above, warp upright, at one scale."""
    warp, weft = cloth.systems
    side = 264.0
    scale = side / (CROSSINGS * max(warp.spacing, weft.spacing))
    x0, y0 = MARGIN / 2, MARGIN
    parts = [f'<text x="{x0}" y="{MARGIN - 16}">from above, warp upright: {CROSSINGS} x {CROSSINGS}</text>']
    ends, picks = cloth.top.shape
    wide, high = weft.spacing * scale, warp.spacing * scale
    thick = (warp.yarn.width * scale, weft.yarn.width * scale)
    for on_top in (False, True):
        for i in range(CROSSINGS):
            for j in range(CROSSINGS):
                up = bool(cloth.top[i % ends, j % picks])
                x, y = x0 + (i + 0.5) * wide, y0 + (j + 0.5) * high
                if up == on_top:
                    parts.append(_bar(x - thick[0] / 2, y - high / 2, thick[0], high, WARP))
                else:
                    parts.append(_bar(x - wide / 2, y - thick[1] / 2, wide, thick[1], WEFT))
    return parts


def _bar(x: float, y: float, width: float, height: float, colour: str) -> str:
    return (
        f'<rect x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}" fill="{colour}" '
        'stroke="white" stroke-width="0.6"/>'
    )


def _cuts(cloth: Woven) -> list[str]:
    """Draw a warp and a weft yarn from the side, the others as ellipses."""
    parts = []
    rows = zip(
        cloth.systems, cloth.systems[::-1], (cloth.top, ~cloth.top.T), (WARP, WEFT), (WEFT, WARP), strict=True
    )
    for row, (own, other, top, colour, others) in enumerate(rows):
        parts += _cut(own, other, [bool(one) for one in top[0]], 318.0, 110.0 + 150.0 * row, (colour, others))
        name = ("a warp yarn", "a weft yarn")[row]
        crimp = 100.0 * (own.length / own.spacing - 1.0)
        parts.append(f'<text x="318" y="{54 + 150 * row}">{name} from the side, crimp {crimp:.1f} %</text>')
    return parts


def _cut(
    own: System, other: System, top: list[bool], x0: float, y0: float, colours: tuple[str, str]
) -> list[str]:
    scale = 270.0 / (CROSSINGS * own.spacing)
    points, parts = [], []
    for i in range(CROSSINGS + 1):
        sign = 1.0 if top[i % len(top)] else -1.0
        x = x0 + i * own.spacing * scale
        points.append((x, y0 - sign * own.wave / 2 * scale))
        there = y0 + sign * other.wave / 2 * scale
        parts.append(
            f'<ellipse cx="{x:.2f}" cy="{there:.2f}" rx="{other.yarn.width / 2 * scale:.2f}" '
            f'ry="{other.yarn.height / 2 * scale:.2f}" fill="{colours[1]}"/>'
        )
    path = f"M{points[0][0]:.2f} {points[0][1]:.2f}" + "".join(
        f" C{(a[0] + b[0]) / 2:.2f} {a[1]:.2f} {(a[0] + b[0]) / 2:.2f} {b[1]:.2f} {b[0]:.2f} {b[1]:.2f}"
        for a, b in pairwise(points)
    )
    thick = own.yarn.height * scale
    parts.append(f'<path d="{path}" fill="none" stroke="{colours[0]}" stroke-width="{thick:.2f}"/>')
    return parts


def _curves(cloth: Woven) -> list[str]:
    """Draw tension over strain in both directions, each pulled alone."""
    x0, y0, wide, high = 660.0, float(HEIGHT - MARGIN), 276.0, float(HEIGHT - 2 * MARGIN)
    most = 1.1 * max(one.curve[-1].strain[axis] for axis, one in enumerate((cloth.warp, cloth.weft)))
    step = 10.0 ** math.floor(math.log10(most))
    step *= next(factor for factor in (0.2, 0.5, 1.0, 2.0) if most / (step * factor) <= 6.0 or factor == 2.0)
    parts = [
        f'<text x="{x0}" y="{MARGIN - 16}">tension [N/m] over strain [%], pulled alone</text>',
        f'<path d="M{x0} {MARGIN} V{y0} H{x0 + wide}" fill="none" stroke="{INK}"/>',
    ]
    for tick in np.arange(0.0, most + 1e-12, step):
        x = x0 + tick / most * wide
        parts.append(f'<text x="{x:.1f}" y="{y0 + 18}" text-anchor="middle">{100 * tick:.3g}</text>')
    for tension in (0, 250, 500, 750, 1000):
        y = y0 - tension / TENSIONS[-1] * high
        parts.append(f'<text x="{x0 - 6}" y="{y + 4:.1f}" text-anchor="end">{tension}</text>')
    for axis, (direction, colour, name) in enumerate(
        ((cloth.warp, WARP, "warp"), (cloth.weft, WEFT, "weft"))
    ):
        points = [
            (0.0, 0.0),
            *((one.strain[axis], n) for one, n in zip(direction.curve, TENSIONS, strict=True)),
        ]
        drawn = " ".join(
            f"{x0 + strain / most * wide:.2f},{y0 - n / TENSIONS[-1] * high:.2f}" for strain, n in points
        )
        parts.append(f'<polyline points="{drawn}" fill="none" stroke="{colour}" stroke-width="2.5"/>')
        parts.append(f'<text x="{x0 + 12}" y="{MARGIN + 14 + 18 * axis}" fill="{colour}">{name}</text>')
    return parts
