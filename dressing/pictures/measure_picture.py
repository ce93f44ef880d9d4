"""A picture of the measurements: the body's front view with tapes and lengths drawn over it, as SVG."""

import base64
from collections.abc import Callable
from html import escape

import numpy as np
from scipy.spatial import ConvexHull

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.avatar_sections import level_cut
from toile.dressing.body.measurements import Measurements
from toile.dressing.files.palette import BODY
from toile.dressing.files.writers.png import png_bytes
from toile.dressing.pictures.preview import PreviewMesh, render_front
from toile.geometry.arrays import Float

SIZE = 900
"""Height of the picture [pixels]."""
COLUMN = 210
"""Width of the column of labels [pixels]."""
ROW = 34
"""Least distance of two labels [pixels]."""
INK, TAPE = "#23272e", "#a8442f"
ARROW = (
    '<defs><marker id="end" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="5" markerHeight="5" '
    f'orient="auto-start-reverse"><path d="M0 0L8 4L0 8z" fill="{TAPE}"/></marker></defs>'
)

Project = Callable[[Float], Float]


def named_measurements(measured: Measurements) -> dict[str, float]:
    """Return what people ask for first, by name [cm]."""
    return {
        "height": 100.0 * measured.height,
        "shoulder": 100.0 * measured.shoulder_width,
        "arm": 100.0 * measured.arm_length,
        "chest": 100.0 * measured.chest,
        "waist": 100.0 * measured.waist,
        "hip": 100.0 * measured.hip,
        "inseam": 100.0 * measured.inseam,
    }


def measure_picture(avatar: Avatar, measured: Measurements) -> bytes:
    """Return an SVG picture of the body from the front that shows where each measurement was taken."""
    body = PreviewMesh(positions=avatar.vertices, faces=avatar.faces, colour=BODY)
    pixels, project = render_front([body], SIZE)
    width = pixels.shape[1]
    drawn, anchors = _tapes(avatar, measured, project)
    for name, points in _lengths(avatar, measured).items():
        (x1, y1), (x2, y2) = ends = project(points)
        drawn.append(
            f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" '
            'marker-start="url(#end)" marker-end="url(#end)"/>'
        )
        anchors[name] = ends[1] if name in ("height", "shoulder") else ends.mean(axis=0)
    picture = base64.b64encode(png_bytes(pixels)).decode()
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width + COLUMN}" height="{SIZE}" '
        f'viewBox="0 0 {width + COLUMN} {SIZE}" font-family="sans-serif" font-size="19">{ARROW}'
        f'<rect width="100%" height="100%" fill="#f6f5f2"/>'
        f'<image width="{width}" height="{SIZE}" href="data:image/png;base64,{picture}"/>'
        f'<g fill="none" stroke="{TAPE}" stroke-width="2.5">{"".join(drawn)}</g>'
        f"{_labels(named_measurements(measured), anchors, width)}</svg>\n"
    ).encode()


def _tapes(avatar: Avatar, measured: Measurements, project: Project) -> tuple[list[str], dict[str, Float]]:
    """Return the girths as drawn tapes, dashed behind the body, and where their labels point."""
    drawn, anchors = [], {}
    floor = float(avatar.vertices[:, 1].min())
    middle = measured.shoulder_point[0] - 0.5 * measured.shoulder_width
    for name in ("chest", "waist", "hip"):
        level = floor + getattr(measured, f"{name}_height")
        girth = getattr(measured, name)
        around = [
            section
            for section in level_cut(avatar.vertices, avatar.faces, level)
            if section.low[0] < middle < section.high[0]
        ]
        section = min(around, key=lambda found: abs(found.girth - girth))
        ring = section.points[ConvexHull(section.points[:, [0, 2]]).vertices]
        seen = project(ring)
        behind = ring[:, 2] < section.centre[2]
        for k in range(len(ring)):
            (x1, y1), (x2, y2) = seen[k - 1], seen[k]
            style = ' stroke-width="1" stroke-dasharray="3 4"' if behind[k - 1] and behind[k] else ""
            drawn.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"{style}/>')
        anchors[name] = seen[int(np.argmax(seen[:, 0]))]
    return drawn, anchors


def _lengths(avatar: Avatar, measured: Measurements) -> dict[str, Float]:
    """Return the two ends of every length [m]."""
    x, y, z = measured.shoulder_point
    middle = x - 0.5 * measured.shoulder_width
    low, high = avatar.vertices.min(axis=0), avatar.vertices.max(axis=0)
    beside, floor = float(low[0] - 0.02 * measured.height), float(low[1])
    wrist = (
        x + measured.arm_length * np.cos(measured.arm_angle),
        y - measured.arm_length * np.sin(measured.arm_angle),
        z,
    )
    return {
        "height": np.array([(beside, floor, z), (beside, float(high[1]), z)]),
        "shoulder": np.array([(2.0 * middle - x, y, z), (x, y, z)]),
        "arm": np.array([(x, y, z), wrist]),
        "inseam": np.array([(middle, floor + measured.crotch_height, z), (middle, floor, z)]),
    }


def _labels(values: dict[str, float], anchors: dict[str, Float], left: int) -> str:
    """Return the names and values beside the picture, each with a line to where it was measured."""
    lines = []
    last = 0.0
    for name in sorted(values, key=lambda name: float(anchors[name][1])):
        x, y = anchors[name]
        row = last = max(float(y), last + ROW)
        lines.append(
            f'<path d="M{x:.1f} {y:.1f}L{left} {row:.1f}H{left + 12}" fill="none" stroke="{INK}" '
            f'stroke-width="0.8"/><text x="{left + 20}" y="{row + 6:.1f}" fill="{INK}">{escape(name)} '
            f'<tspan font-weight="bold">{values[name]:.1f} cm</tspan></text>'
        )
    return "".join(lines)
