"""A distribution as a small picture in a page."""

from array import array
from html import escape

import numpy as np

from toile.dressing.batch.batch_progress import jobs_text

WIDTH, HEIGHT, BASE, TOP = 360, 170, 140, 16
"""Size of the picture, its base line and the top of its highest bar [pixels]."""
BARS = 24


def histogram(title: str, unit: str, values: "array[float]") -> str:
    """Return an SVG figure of values, with their median and 95th percentile; empty without values.

    Where a few values are far from the rest, the axis is logarithmic.
    """
    data = np.array(values, dtype=np.float64)
    if not len(data):
        return ""
    median, high = np.percentile(data, [50.0, 95.0])
    logarithmic = bool(data.min() > 0.0 and data.max() > 30.0 * median)
    shown = np.log10(data) if logarithmic else data
    low, top = float(shown.min()), float(shown.max())
    if top - low < 1e-9 * max(abs(top), 1.0):
        low, top = min(0.0, 2.0 * low), max(2.0 * top, 1e-9)
    counts, _ = np.histogram(shown, bins=BARS, range=(low, top))
    width = WIDTH / BARS
    bars = "".join(
        f'<rect x="{k * width + 1:.1f}" y="{BASE - bar:.1f}" width="{width - 2:.1f}" height="{bar:.1f}">'
        f"<title>{jobs_text(count)}</title></rect>"
        for k, count in enumerate(counts)
        if (bar := (BASE - TOP) * count / counts.max())
    )
    ends = (10.0**low, 10.0**top) if logarithmic else (low, top)
    scale = " (logarithmic)" if logarithmic else ""
    unit = f" {escape(unit)}" if unit else ""
    return (
        f"<figure><figcaption>{escape(title)}{scale}</figcaption>"
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img"><line x1="0" y1="{BASE}" x2="{WIDTH}" y2="{BASE}"/>'
        f'{bars}<text x="0" y="{BASE + 18}">{_short(ends[0])}</text>'
        f'<text x="{WIDTH}" y="{BASE + 18}" text-anchor="end">{_short(ends[1])}{unit}</text></svg>'
        f"<p>median {_short(median)}, 95th percentile {_short(high)}{unit}, {jobs_text(len(data))}</p>"
        "</figure>"
    )


def _short(value: float) -> str:
    """Return a number with three digits, whole where it is large."""
    return f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.3g}"
