"""Panels of drawn pieces placed around a body: front and back flat, sleeves and bands rolled.

Where a piece goes is told, or read from words such as FRONT or SLEEVE; which way up follows from its grain
and from its longest edge that is not sewn, the hem. A sleeve goes to the arm whose armhole it is sewn to.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from toile.dressing.body.measurements import Measurements
from toile.dressing.pattern.drawn.piece import MIRRORED, DrawnPattern, Piece
from toile.dressing.pattern.drawn.seams_file import Place, Worn
from toile.dressing.pattern.drawn.unfold import unfolded
from toile.dressing.pattern.pattern import Panel, Pattern
from toile.dressing.pattern.pattern_curve import edge_length
from toile.dressing.pattern.pattern_outline import default_segments, outline
from toile.dressing.pattern.roles import PanelRole
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

WORDS: tuple[tuple[Place, str], ...] = (
    ("sleeve", r"sleeve|sleeves|slv|sl|cuff|manche|aermel"),
    ("waistband", r"waistband|wb|belt"),
    ("collar", r"collar|collarstand|neckband|ribbing"),
    ("front", r"front|frt|fr|frontsidedart"),
    ("back", r"back|bck|bk|ba"),
)
"""Places and the words for them, each a whole word in the name, category or annotation of a piece."""
BOTTOM = r"skirt|trouser|trousers|pant|pants|jeans|leg|shorts|penelope|titan|waistband"
GAP = 0.05
"""How far in front of and behind the body flat panels start [m]."""
SLEEVE_OUT = 0.09
"""How far out along the arm, from the shoulder, the top of a rolled sleeve starts [m]."""
OPEN_ROLL = 1.12
"""Circumference of a roll over the width of what is rolled: its edges start apart."""
CENTRE_GAP = 0.01
"""Half the gap between the two panels of a pair at the centre of the body [m]."""


@dataclass(frozen=True)
class _Flat:
    """A panel turned upright in its own plane, the cloth around the origin, and where it goes."""

    panel: Panel
    piece: Piece
    place: Place


def placed_pattern(
    drawn: DrawnPattern, body: Measurements, places: Mapping[str, Place], worn: Worn | None
) -> Pattern:
    """Return the pattern around a body.

    Raises InputError for a piece of which nothing says where it goes, and as `unfolded` does.
    """
    pattern = unfolded(drawn)
    pieces = {piece.name: piece for piece in drawn.pieces}
    told = {name: places.get(name) or place_by_words(piece.words) for name, piece in pieces.items()}
    unknown = next((name for name, place in told.items() if place is None), None)
    if unknown is not None:
        raise InputError(
            f"{drawn.name}: nothing says where piece '{unknown}' goes on the body; add [piece.{unknown}] "
            'with place = "front", "back", "sleeve", "waistband" or "collar" to the seams file',
            field=f"piece.{unknown}.place",
        )
    all_words = " ".join([drawn.name, *(piece.words for piece in drawn.pieces)])
    bottom = worn == "bottom" or (worn is None and _says(all_words, BOTTOM) and "sleeve" not in told.values())
    flats = []
    for panel in pattern.panels:
        piece = pieces[panel.name.removesuffix(MIRRORED)]
        place = told[piece.name]
        assert place is not None
        flats.append(_Flat(_upright(panel, pattern, place), piece, place))
    placed = {
        flat.panel.name: _front_or_back(flat, pattern, body, bottom)
        for flat in flats
        if flat.place in ("front", "back")
    }
    for flat in flats:
        if flat.place == "sleeve":
            placed[flat.panel.name] = _sleeve(flat.panel, _side_of(flat.panel, pattern, placed), body)
        elif flat.place in ("waistband", "collar"):
            placed[flat.panel.name] = _band(flat.panel, flat.place, body)
    return replace(pattern, panels=tuple(placed[panel.name] for panel in pattern.panels))


def place_by_words(words: str) -> Place | None:
    """Return where a piece goes by the words that a file has for it, None if they do not say."""
    return next((place for place, pattern in WORDS if _says(words, pattern)), None)


def _says(words: str, pattern: str) -> bool:
    spread = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", words)
    tokens = re.split(r"[^A-Za-z]+", f"{words} {spread}".lower())
    return any(re.fullmatch(pattern, token) for token in tokens)


def _polygon(panel: Panel) -> Float:
    return outline(panel, default_segments(panel, 60))[0]


def _upright(panel: Panel, pattern: Pattern, place: Place) -> Panel:
    """Return the panel with its hem below, or a band along x, centred in x and its top at y = 0."""
    sewn = {(p.panel, p.edge) for seam in pattern.seams for p in (*seam.a, *seam.b)}
    polygon = _polygon(panel)
    if place in ("waistband", "collar"):
        centred = polygon - polygon.mean(axis=0)
        axis = np.linalg.svd(centred, full_matrices=False)[2][0]
        turn = -math.degrees(math.atan2(axis[1], axis[0]))
        turn -= 180.0 * round(turn / 180.0)
    else:
        free = [n for n in range(len(panel.edges)) if (panel.name, n) not in sewn]
        longest = max(free or range(len(panel.edges)), key=lambda n: edge_length(panel, n))
        edge = panel.edges[longest]
        middle = np.mean([panel.vertices[edge.start], panel.vertices[edge.end]], axis=0)
        up = polygon.mean(axis=0) - middle
        warp = math.radians(panel.warp_degrees)
        grain = np.array([-math.sin(warp), math.cos(warp)])
        across = np.array([grain[1], -grain[0]])
        axis = max((grain, -grain, across, -across), key=lambda d: float(d @ up))
        turn = math.degrees(math.atan2(axis[0], axis[1]))
    turned = _turned(panel, turn)
    polygon = _polygon(turned)
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    return _moved(turned, -0.5 * (low[0] + high[0]), -high[1])


def _turned(panel: Panel, degrees: float) -> Panel:
    """Return the panel turned in its plane, exactly by right angles."""
    quarter = round(degrees / 90.0)
    if abs(degrees - 90.0 * quarter) < 0.5:
        c, s = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarter % 4]
    else:
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    warp = panel.warp_degrees + degrees
    return replace(
        panel,
        vertices=tuple((c * x - s * y, s * x + c * y) for x, y in panel.vertices),
        lines=tuple(tuple((c * x - s * y, s * x + c * y) for x, y in line) for line in panel.lines),
        warp_degrees=warp - 180.0 * round(warp / 180.0),
    )


def _moved(panel: Panel, x: float, y: float) -> Panel:
    return replace(
        panel,
        vertices=tuple((px + x, py + y) for px, py in panel.vertices),
        lines=tuple(tuple((px + x, py + y) for px, py in line) for line in panel.lines),
    )


def _front_or_back(flat: _Flat, pattern: Pattern, body: Measurements, bottom: bool) -> Panel:
    """Place a flat panel before or behind the body."""
    panel = flat.panel
    z_back, z_front = body.torso_depth
    front = flat.place == "front"
    top = body.waist_height + 0.01 if bottom else _neck_level(body)
    x = 0.0
    if flat.piece.pair:
        # A panel of a pair lies beside the middle, the edge that is sewn to its twin, or else the longest
        # one that is upright, towards it.
        centre = _centre_edge(panel, pattern)
        half = 0.5 * float(np.ptp(_polygon(panel)[:, 0])) + CENTRE_GAP
        x = -half if centre > 0.0 else half
        x = x if front else -x
    return replace(
        panel,
        translation=(x, top, z_front + GAP if front else z_back - GAP),
        rotation_degrees=(0.0, 0.0 if front else 180.0, 0.0),
        label="leg" if bottom else "body",
        role="leg" if bottom else "torso",
    )


def _centre_edge(panel: Panel, pattern: Pattern) -> float:
    """Return the mean x of the edges that are sewn to the panel's twin, or free and upright."""
    twin = panel.name.removesuffix(MIRRORED) + ("" if panel.name.endswith(MIRRORED) else MIRRORED)
    runs = [(s.a, s.b) for s in pattern.seams] + [(s.b, s.a) for s in pattern.seams]
    edges = [p.edge for a, b in runs if any(q.panel == twin for q in b) for p in a if p.panel == panel.name]
    if not edges:
        sewn = {p.edge for a, _ in runs for p in a if p.panel == panel.name}
        free = [n for n in range(len(panel.edges)) if n not in sewn] or list(range(len(panel.edges)))
        edges = [max(free, key=lambda n: abs(_rise(panel, n)))]
    return float(
        np.mean([panel.vertices[v][0] for n in edges for v in (panel.edges[n].start, panel.edges[n].end)])
    )


def _rise(panel: Panel, edge: int) -> float:
    side = panel.edges[edge]
    return panel.vertices[side.end][1] - panel.vertices[side.start][1]


def _neck_level(body: Measurements) -> float:
    """Return the height of the point where neck and shoulder seam meet [m], as the T-shirt draft has it."""
    run = max(body.shoulder_width / 2.0 - body.neck_width / 2.0 - 0.015, 0.04)
    shoulder = body.shoulder_point[1] + 0.005
    return shoulder + min(max(body.neck_height - shoulder, 0.21 * run), 0.58 * run)


def _side_of(panel: Panel, pattern: Pattern, placed: Mapping[str, Panel]) -> float:
    """Return +1 where a sleeve is sewn to the left of the body, -1 where to the right."""
    total = 0.0
    for seam in pattern.seams:
        for run, other in ((seam.a, seam.b), (seam.b, seam.a)):
            if not any(part.panel == panel.name for part in run):
                continue
            for part in other:
                if part.panel in placed:
                    partner = placed[part.panel]
                    edge = partner.edges[part.edge]
                    x = 0.5 * (partner.vertices[edge.start][0] + partner.vertices[edge.end][0])
                    total += partner.translation[0] + (x if partner.rotation_degrees[1] == 0.0 else -x)
    if total == 0.0:
        raise InputError(
            f"{pattern.name}: sleeve '{panel.name}' is sewn to neither front nor back; "
            "add its seam to the seams file",
            field="seams",
        )
    return math.copysign(1.0, total)


def _sleeve(panel: Panel, side: float, body: Measurements) -> Panel:
    """Roll a sleeve around an arm, the middle of its cap on top, its right side outside."""
    width = float(np.ptp(_polygon(panel)[:, 0]))
    radius = OPEN_ROLL * width / (2.0 * math.pi)
    cosine, sine = math.cos(body.arm_angle), math.sin(body.arm_angle)
    outward, upward = np.array([side * cosine, -sine]), np.array([side * sine, cosine])
    arm = body.upper_arm / (2.0 * math.pi)
    axis = np.array([side * body.shoulder_point[0], body.shoulder_point[1]]) - arm * upward
    x, y = axis + radius * upward + SLEEVE_OUT * outward
    z = float(body.shoulder_point[2]) if len(body.shoulder_point) > 2 else 0.5 * sum(body.torso_depth)
    role: PanelRole = "sleeve"
    return replace(
        panel,
        translation=(float(x), float(y), z),
        rotation_degrees=(math.degrees(math.atan2(-cosine, sine)), 90.0 * side, 0.0),
        label="arm",
        role=role,
        roll_radius=radius,
    )


def _band(panel: Panel, place: Place, body: Measurements) -> Panel:
    """Roll a band around the waist or the neck, its middle in front."""
    polygon = _polygon(panel)
    width, height = np.ptp(polygon, axis=0)
    girth, level = (body.waist, body.waist_height) if place == "waistband" else (body.neck, body.neck_height)
    radius = max(OPEN_ROLL * float(width), 1.25 * girth) / (2.0 * math.pi)
    z = 0.5 * sum(body.torso_depth)
    return replace(
        panel,
        translation=(0.0, level + float(height), z + radius),
        label="leg" if place == "waistband" else "body",
        role="leg" if place == "waistband" else "torso",
        roll_radius=radius,
    )
