"""A chart as SVG: error against CPU time on logarithmic axes, a colour per curve, the Pareto front below."""

import math
from collections.abc import Iterable, Sequence
from html import escape

from toile.studies.speed_error.pareto import pareto_front
from toile.studies.speed_error.point import Chart, Point

WIDTH, HEIGHT = 960, 520
LEFT, RIGHT, TOP, BOTTOM = 66, 290, 44, 54
"""Margins [pixels]; the legend is on the right."""
ROW = 21
"""Height of a line of the legend [pixels]."""
INK, FAINT, FRONT, FLOOR = "#23272e", "#dcdad4", "#f0c44c", "#ecebe6"
COLOURS = (
    "#1f6fb4", "#d1495b", "#2a9d5c", "#8e5bb5", "#e07b1a", "#159ea3", "#7a5230", "#d457a6", "#6b7a12",
    "#555b66",
)  # fmt: skip
SIDES = (40, 4, 3)
"""Corners of the markers of the first curves, the next ones and so on: circles, squares, triangles."""
MARKER = 5.0
TICKS = ((2.5, (1.0,)), (1.0, (1.0, 2.0, 5.0)), (0.0, (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0)))
"""Decades above which only these steps of every decade are marked."""
LEAST_DECADES = 0.6
"""Of an axis: differences of a few percent shall look like that."""


class Axis:
    """A logarithmic axis from pixel `start` to `end` for values between `low` and `high`, a little beyond."""

    def __init__(self, values: Iterable[float], start: float, end: float) -> None:
        logs = [math.log10(value) for value in values]
        low, high = min(logs, default=0.0), max(logs, default=1.0)
        room = max(0.06 * (high - low), 0.08, 0.5 * (LEAST_DECADES - high + low))
        self._low, self._high = low - room, high + room
        self._start, self._end = start, end

    def at(self, value: float) -> float:
        """Return the pixel of a value."""
        share = (math.log10(value) - self._low) / (self._high - self._low)
        return self._start + share * (self._end - self._start)

    def ticks(self) -> list[float]:
        """Return round values to mark: powers of ten, and others where there is room."""
        steps = next(steps for decades, steps in TICKS if self._high - self._low > decades)
        found = [
            step * 10.0**power
            for power in range(math.floor(self._low), math.ceil(self._high) + 1)
            for step in steps
        ]
        return [tick for tick in found if self._low <= math.log10(tick) <= self._high]


def chart_svg(chart: Chart) -> str:
    """Return the picture of a chart; points without a finite error above zero are not on it."""
    shown = [point for point in chart.points if math.isfinite(point.error) and point.error > 0.0]
    x = Axis((max(point.cpu, 1e-4) for point in shown), LEFT, WIDTH - RIGHT)
    floors = [chart.floor] if chart.floor > 0.0 else []
    y = Axis([*(point.error for point in shown), *floors], HEIGHT - BOTTOM, TOP)
    curves = list(dict.fromkeys(point.curve for point in chart.points))
    parts = [
        _frame(chart, x, y),
        _floor(chart.floor, y) if floors else "",
        _front(pareto_front(shown), x, y),
    ]
    for index, name in enumerate(curves):
        own = [point for point in shown if point.curve == name]
        parts.append(_curve(own, index, x, y, chart.unit))
    parts.append(_legend(curves, any(point.preset for point in shown), bool(floors)))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
        f'viewBox="0 0 {WIDTH} {HEIGHT}" role="img" font-family="sans-serif" font-size="13" fill="{INK}">'
        f"<title>{escape(chart.scene)}: {escape(chart.title)}</title>"
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>{"".join(parts)}</svg>\n'
    )


def _frame(chart: Chart, x: Axis, y: Axis) -> str:
    """Title, axes and grid."""
    right, floor = WIDTH - RIGHT, HEIGHT - BOTTOM
    parts = [f'<text x="{LEFT}" y="24" font-size="16">{escape(chart.scene)}: {escape(chart.title)}</text>']
    for tick in x.ticks():
        at = f"{x.at(tick):.1f}"
        parts.append(
            f'<path d="M{at} {TOP}V{floor}" stroke="{FAINT}"/>'
            f'<text x="{at}" y="{floor + 18}" text-anchor="middle">{tick:g}</text>'
        )
    for tick in y.ticks():
        height = y.at(tick)
        parts.append(
            f'<path d="M{LEFT} {height:.1f}H{right}" stroke="{FAINT}"/>'
            f'<text x="{LEFT - 7}" y="{height + 4.5:.1f}" text-anchor="end">{tick:g}</text>'
        )
    parts.append(
        f'<path d="M{LEFT} {TOP}V{floor}H{right}" fill="none" stroke="{INK}"/>'
        f'<text x="{0.5 * (LEFT + right):.0f}" y="{HEIGHT - 14}" text-anchor="middle">CPU time [s]</text>'
        f'<text transform="translate(17 {0.5 * (TOP + floor):.0f}) rotate(-90)" text-anchor="middle">'
        f"error [{escape(chart.unit)}]</text>"
    )
    return "".join(parts)


def _floor(floor: float, y: Axis) -> str:
    """Shade what lies below the floor of the reference."""
    top = y.at(floor)
    return (
        f'<rect x="{LEFT}" y="{top:.1f}" width="{WIDTH - RIGHT - LEFT}" '
        f'height="{max(HEIGHT - BOTTOM - top, 0.0):.1f}" fill="{FLOOR}" fill-opacity="0.8"/>'
    )


def _front(front: Sequence[Point], x: Axis, y: Axis) -> str:
    """Draw the Pareto front as steps: the error that can be had for each time."""
    if not front:
        return ""
    path = f"M{x.at(max(front[0].cpu, 1e-4)):.1f} {y.at(front[0].error):.1f}"
    for point in front[1:]:
        path += f"H{x.at(max(point.cpu, 1e-4)):.1f}V{y.at(point.error):.1f}"
    path += f"H{WIDTH - RIGHT}"
    return f'<path d="{path}" fill="none" stroke="{FRONT}" stroke-width="8" stroke-opacity="0.75"/>'


def _curve(points: Sequence[Point], index: int, x: Axis, y: Axis, unit: str) -> str:
    """Draw the points of a curve, joined; presets are ringed and named, results with crossings hollow."""
    colour = COLOURS[index % len(COLOURS)]
    places = [(x.at(max(point.cpu, 1e-4)), y.at(point.error)) for point in points]
    line = "L".join(f"{px:.1f} {py:.1f}" for px, py in places)
    parts = [f'<path d="M{line}" fill="none" stroke="{colour}" stroke-width="1.6"/>'] if points else []
    for point, (px, py) in zip(points, places, strict=True):
        said = f"{point.curve}, {point.label}: {point.error:.3g} {unit}, {point.cpu:.3g} CPU s"
        crossed = f", {point.crossings} crossings" if point.crossings else ""
        parts.append(_marker(px, py, index, colour, not point.crossings, said + crossed))
        if point.preset:
            parts.append(
                f'<circle cx="{px:.1f}" cy="{py:.1f}" r="10" fill="none" stroke="{INK}" stroke-width="1.5"/>'
                f'<text x="{px + 13:.1f}" y="{py - 8:.1f}" font-weight="bold">{escape(point.preset)}</text>'
            )
    return "".join(parts)


def _marker(px: float, py: float, index: int, colour: str, solid: bool, said: str) -> str:
    """Draw one marker with what it says when pointed at."""
    sides = SIDES[index // 4 % len(SIDES)]
    turn = 0.25 * math.pi if sides == 4 else -0.5 * math.pi
    corners = " ".join(
        f"{px + MARKER * math.cos(turn + 2.0 * math.pi * k / sides):.1f},"
        f"{py + MARKER * math.sin(turn + 2.0 * math.pi * k / sides):.1f}"
        for k in range(sides)
    )
    fill = colour if solid else "#ffffff"
    return (
        f'<polygon points="{corners}" fill="{fill}" stroke="{colour}" stroke-width="1.6">'
        f"<title>{escape(said)}</title></polygon>"
    )


def _legend(curves: Sequence[str], presets: bool, floor: bool) -> str:
    """Name the curves and what else is drawn."""
    left = WIDTH - RIGHT + 22
    parts = []
    for index, name in enumerate(curves):
        colour, middle = COLOURS[index % len(COLOURS)], TOP + 10 + ROW * index
        parts.append(
            f'<path d="M{left} {middle}h26" stroke="{colour}" stroke-width="1.6"/>'
            + _marker(left + 13.0, middle, index, colour, True, name)
            + f'<text x="{left + 34}" y="{middle + 4.5}">{escape(name)}</text>'
        )
    below = TOP + 22 + ROW * len(curves)
    rows = [
        (f'<path d="M{left} {{0}}h26" stroke="{FRONT}" stroke-width="8"/>', "nothing measured beats this"),
    ]
    if floor:
        rows.append(
            (
                f'<rect x="{left}" y="{{1}}" width="26" height="14" fill="{FLOOR}"/>',
                "below the floor of the reference",
            )
        )
    if presets:
        rows.append(
            (
                f'<circle cx="{left + 13}" cy="{{0}}" r="8" fill="none" stroke="{INK}" stroke-width="1.5"/>',
                "presets",
            )
        )
    for index, (drawn, said) in enumerate(rows):
        middle = below + ROW * index
        parts.append(
            drawn.format(middle, middle - 7) + f'<text x="{left + 34}" y="{middle + 4.5}">{said}</text>'
        )
    return "".join(parts)
