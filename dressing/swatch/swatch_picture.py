"""A picture of an experiment: the swatch, from above or from the side, and its curve, as SVG."""

import math

import numpy as np

from toile.dressing.swatch.curve import Curve
from toile.dressing.weave.weave_picture import HEIGHT, INK, MARGIN, WARP, WEFT, WIDTH
from toile.engine.swatch.equilibrium import Patch
from toile.geometry.arrays import Float

SIDE = 400.0
TICKS = 5


def swatch_svg(curve: Curve) -> str:
    """Return the picture as SVG."""
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
        f'font-size="13" fill="{INK}">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        f'<text x="{MARGIN / 2}" y="{MARGIN - 20}">{curve.title}</text>',
        *_yarns(curve.patch), *_chart(curve), "</svg>",
    ]  # fmt: skip
    return "\n".join(parts) + "\n"


def _yarns(patch: Patch) -> list[str]:
    """Draw every yarn as a line through its crossings: along x and y, or x and z where it left its plane."""
    net = patch.net
    places = patch.state[: net.crossings]
    lies_flat = float(np.ptp(places[:, 2])) < 1e-3 * float(np.ptp(places[:, :2]))
    shown = places[:, [0, 1]] if lies_flat else _from_the_side(places)
    low, span = shown.min(axis=0), np.ptp(shown, axis=0)
    scale = min(SIDE / max(float(span[0]), 1e-12), (HEIGHT - 2.0 * MARGIN) / max(float(span[1]), 1e-12))
    drawn = np.column_stack(
        [MARGIN / 2 + scale * (shown[:, 0] - low[0]), HEIGHT - MARGIN - scale * (shown[:, 1] - low[1])]
    )
    parts = []
    for lines, colour, strand in ((net.grid, WARP, net.strands[0]), (net.grid.T, WEFT, net.strands[1])):
        thick = max(0.6 * scale * strand.width, 0.6)
        for line in lines:
            points = " ".join(f"{x:.1f},{y:.1f}" for x, y in drawn[line[line >= 0]])
            parts.append(
                f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="{thick:.1f}" '
                'stroke-opacity="0.8"/>'
            )
    return parts


def _from_the_side(places: Float) -> Float:
    """Return places seen from the side and 20 degrees from above, shape (n, 2)."""
    lift, turn = math.radians(20.0), math.radians(25.0)
    across = places[:, 1] * math.cos(turn) - places[:, 0] * math.sin(turn)
    along = places[:, 0] * math.cos(turn) + places[:, 1] * math.sin(turn)
    return np.column_stack([along, places[:, 2] * math.cos(lift) + across * math.sin(lift)])


def _chart(curve: Curve) -> list[str]:
    """Draw the curve."""
    if not curve.rows:
        return []
    x0, y0, wide, high = 560.0, float(HEIGHT - MARGIN), 370.0, float(HEIGHT - 2 * MARGIN)
    figures = np.array(curve.rows)[:, list(curve.axes)]
    figures = np.concatenate([np.zeros((1, 2)), figures])
    most = np.maximum(np.abs(figures).max(axis=0), 1e-12)
    names = [curve.columns[axis] for axis in curve.axes]
    parts = [
        f'<path d="M{x0} {MARGIN} V{y0} H{x0 + wide}" fill="none" stroke="{INK}"/>',
        f'<text x="{x0 - 40}" y="{MARGIN - 20}">{names[1]}</text>',
        f'<text x="{x0 + wide}" y="{y0 + 36}" text-anchor="end">{names[0]}</text>',
    ]
    for share in np.linspace(0.0, 1.0, TICKS):
        x, y = x0 + share * wide, y0 - share * high + 4.0
        parts.append(f'<text x="{x:.0f}" y="{y0 + 18}" text-anchor="middle">{share * most[0]:.3g}</text>')
        parts.append(f'<text x="{x0 - 6}" y="{y:.0f}" text-anchor="end">{share * most[1]:.3g}</text>')
    points = " ".join(
        f"{x0 + abs(x) / most[0] * wide:.1f},{y0 - abs(y) / most[1] * high:.1f}" for x, y in figures
    )
    parts.append(f'<polyline points="{points}" fill="none" stroke="{WARP}" stroke-width="2.5"/>')
    return parts
