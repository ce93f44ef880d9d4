"""Measured curves and the lines fitted to them, as SVG."""

from html import escape

import numpy as np

from toile.dressing.fabric_fit.estimate import MeasuredCurve
from toile.geometry.arrays import Float

WIDTH, HEIGHT, MARGIN = 360, 280, 48
"""Room of one curve [pixels]."""
COLUMNS = 3
INK, FAINT, LINE = "#23272e", "#dcdad4", "#c0392b"
TICKS = 4


def curves_svg(curves: tuple[MeasuredCurve, ...], title: str) -> bytes:
    """Return a picture of curves side by side: measured points, and the lines of the model."""
    columns = max(min(COLUMNS, len(curves)), 1)
    rows = max(-(-len(curves) // columns), 1)
    width, height = columns * WIDTH, rows * HEIGHT + 40
    parts = [
        f'<g transform="translate({(k % columns) * WIDTH},{40 + (k // columns) * HEIGHT})">'
        f"{_curve(curve)}</g>"
        for k, curve in enumerate(curves)
    ]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12" fill="{INK}">'
        f'<rect width="100%" height="100%" fill="#ffffff"/>'
        f'<text x="16" y="26" font-size="17">{escape(title)}: points measured, lines fitted</text>'
        f"{''.join(parts)}</svg>\n"
    ).encode()


def _curve(curve: MeasuredCurve) -> str:
    """Return one curve with its axes."""
    x_at, x_ticks = _axis(curve.x, MARGIN + 10, WIDTH - 16)
    y_at, y_ticks = _axis(np.concatenate([curve.y, curve.line]), HEIGHT - MARGIN, 30)
    parts = [f'<text x="{MARGIN + 10}" y="18" font-weight="bold">{escape(curve.title)}</text>']
    for value in x_ticks:
        at = x_at(value)
        parts.append(f'<path d="M{at:.1f} 30V{HEIGHT - MARGIN}" stroke="{FAINT}"/>')
        parts.append(f'<text x="{at:.1f}" y="{HEIGHT - MARGIN + 15}" text-anchor="middle">{value:.3g}</text>')
    for value in y_ticks:
        at = y_at(value)
        parts.append(f'<path d="M{MARGIN + 10} {at:.1f}H{WIDTH - 16}" stroke="{FAINT}"/>')
        parts.append(f'<text x="{MARGIN + 5}" y="{at + 4:.1f}" text-anchor="end">{value:.3g}</text>')
    parts += [
        f'<circle cx="{x_at(x):.1f}" cy="{y_at(y):.1f}" r="2" fill="{INK}" fill-opacity="0.55"/>'
        for x, y in zip(curve.x.tolist(), curve.y.tolist(), strict=True)
    ]
    way = " ".join(
        f"{x_at(x):.1f},{y_at(y):.1f}" for x, y in zip(curve.x.tolist(), curve.line.tolist(), strict=True)
    )
    parts.append(f'<polyline points="{way}" fill="none" stroke="{LINE}" stroke-width="1.6"/>')
    middle = 0.5 * (MARGIN + WIDTH)
    parts.append(f'<text x="{middle}" y="{HEIGHT - 12}" text-anchor="middle">{escape(curve.x_name)}</text>')
    parts.append(
        f'<text transform="translate(12,{0.5 * HEIGHT}) rotate(-90)" text-anchor="middle">'
        f"{escape(curve.y_name)}</text>"
    )
    return "".join(parts)


class _Scale:
    """Pixels of values."""

    def __init__(self, low: float, high: float, start: float, end: float) -> None:
        self._low, self._per, self._start = low, (end - start) / max(high - low, 1e-300), start

    def __call__(self, value: float) -> float:
        """Return the pixel of a value."""
        return self._start + (value - self._low) * self._per


def _axis(values: Float, start: float, end: float) -> tuple[_Scale, list[float]]:
    """Return the scale of an axis that has room for values and zero, and its ticks."""
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    high = high if high > low else low + 1.0
    return _Scale(low, high, start, end), np.linspace(low, high, TICKS + 1).tolist()
