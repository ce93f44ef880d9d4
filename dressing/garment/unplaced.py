"""Patterns without placement, all panels in one place: laid around the body by their names, roles and seams.

The largest panel of the front and that of the back are put before and behind the body, at the height that
their edges' roles ask for. Every other panel is laid beside one it is sewn to, on the side that its name
says: edge along edge, or a sleeve along the arm.
"""

import math
import re
from collections import deque
from dataclasses import replace

import numpy as np

from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.pattern_place import LEVELS
from toile.dressing.pattern.pattern import Panel, Pattern, Stitch
from toile.dressing.pattern.pattern_outline import edge_ends, is_clockwise, to_world
from toile.geometry.errors import InputError

BESIDE, BESIDE_ARMHOLE = 0.04, 0.09
"""Distance between edges that will be sewn together [m]; of a sleeve from the armhole, along the arm."""
OFF_BODY = 0.05
"""How far before or behind the torso panels start [m]."""
NEARER = 0.03
"""How much nearer panels start that are laid beside others [m]: sleeves hang behind the front's plane."""
SIDES = {"front": 1.0, "f": 1.0, "ftorso": 1.0, "back": -1.0, "b": -1.0, "btorso": -1.0}
"""Words in the name of a panel to the side of the body it lies on."""


def placed_by_seams(pattern: Pattern, form: DressForm) -> Pattern:
    """Return a pattern whose panels all lie in one place laid around a body; any other one as it is.

    Raises InputError naming a panel whose place cannot be told.
    """
    if len({(panel.translation, panel.rotation_degrees) for panel in pattern.panels}) > 1:
        return pattern
    if len(pattern.panels) == 1 or not pattern.stitches:
        return pattern
    body = form.measured
    if isinstance(body, InputError):
        raise InputError(
            f"{pattern.name}: its panels have no places, and the body cannot be measured ({body}); give "
            "every panel a translation"
        )
    done: dict[str, Panel] = {}
    for side in (1.0, -1.0):
        own = [panel for panel in pattern.panels if _side(panel) == side and panel.role != "sleeve"]
        if own:
            root = max(own, key=lambda panel: (_size(panel), panel.name))
            done[root.name] = _before_body(root, side, body, form)
    waiting = deque(done)
    while waiting:
        name = waiting.popleft()
        for stitch in pattern.stitches:
            other = stitch.partner(name)
            if other is None or other in done:
                continue
            side = math.copysign(1.0, done[name].translation[2] - _middle_depth(body))
            if _side(pattern.panel(other)) in (None, side):
                done[other] = _beside(done[name], pattern.panel(other), stitch, side, body)
                waiting.append(other)
    lost = [panel.name for panel in pattern.panels if panel.name not in done]
    if lost:
        raise InputError(
            f"{pattern.name}: its panels lie all in one place, and where '{lost[0]}' belongs cannot be told; "
            'give every panel a translation, or names with "front" and "back"',
            field=f"pattern.panels.{lost[0]}.translation",
        )
    note = "The pattern does not place its panels; they are laid around the body by their names and seams."
    panels = tuple(done[panel.name] for panel in pattern.panels)
    return replace(pattern, panels=panels, notes=(*pattern.notes, note))


def _side(panel: Panel) -> float | None:
    """Return 1 for the front, -1 for the back, None where the name says neither."""
    words = re.split(r"[^a-z]+", panel.name.lower())
    return next((SIDES[word] for word in words if word in SIDES), None)


def _size(panel: Panel) -> float:
    return float(np.prod(np.ptp(np.array(panel.vertices), axis=0)))


def _middle_depth(body: Measurements) -> float:
    return 0.5 * sum(body.torso_depth)


def _turn(panel: Panel, side: float) -> float:
    """Turn about the vertical axis that shows the right side of a panel outwards [degrees]."""
    return 180.0 if is_clockwise(panel) == (side > 0.0) else 0.0


def _before_body(panel: Panel, side: float, body: Measurements, form: DressForm) -> Panel:
    """Return a panel before the body (side 1) or behind it (-1), at the height of its edges' roles."""
    role = next((role for role in LEVELS if any(edge.role == role for edge in panel.edges)), None)
    if role is None:
        role = "waist" if panel.role == "leg" else "collar"
    at = [panel.vertices[edge.start] for edge in panel.edges if edge.role == role] or panel.vertices
    at = [*at, *(panel.vertices[edge.end] for edge in panel.edges if edge.role == role)]
    low, high = form.avatar.vertices.min(axis=0), form.avatar.vertices.max(axis=0)
    level, below = LEVELS[role]
    turn = _turn(panel, side)
    across = [x for x, _ in panel.vertices]
    middle = 0.5 * (min(across) + max(across)) * (-1.0 if turn else 1.0)
    return replace(
        panel,
        translation=(
            0.5 * float(low[0] + high[0]) - middle,
            float(low[1]) + float(getattr(body, level)) - below - max(y for _, y in at),
            body.torso_depth[1] + OFF_BODY if side > 0.0 else body.torso_depth[0] - OFF_BODY,
        ),
        rotation_degrees=(0.0, turn, 0.0),
    )


def _beside(placed: Panel, panel: Panel, stitch: Stitch, side: float, body: Measurements) -> Panel:
    """Return a panel beside a placed one, its edge of a stitch along the other's, or along the arm."""
    first, second = (stitch.panel_a, stitch.edge_a), (stitch.panel_b, stitch.edge_b)
    if first[0] != placed.name:
        first, second = second, first
    there = edge_ends(placed, first[1])[:, :2]
    flat = replace(panel, translation=(0.0, 0.0, 0.0), rotation_degrees=(0.0, _turn(panel, side), 0.0))
    here = edge_ends(flat, second[1])[:, :2]
    if not stitch.right_wrong:
        here = here[::-1]
    wanted, own = there[1] - there[0], here[1] - here[0]
    away = np.array([wanted[1], -wanted[0]]) / max(float(np.linalg.norm(wanted)), 1e-9)
    centre = to_world(placed, np.array(placed.vertices))[:, :2].mean(axis=0)
    if away @ (there.mean(axis=0) - centre) < 0.0:
        away = -away
    gap = BESIDE
    if panel.role == "sleeve" and placed.role != "sleeve":
        outwards = 1.0 if away[0] > 0.0 else -1.0
        away = np.array([outwards * math.cos(body.arm_angle), -math.sin(body.arm_angle)])
        own = to_world(flat, np.array(panel.vertices))[:, :2].mean(axis=0) - here.mean(axis=0)
        wanted, gap = away, BESIDE_ARMHOLE
    angle = math.atan2(wanted[1], wanted[0]) - math.atan2(own[1], own[0])
    turned = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    x, y = there.mean(axis=0) + gap * away - turned @ here.mean(axis=0)
    return replace(
        flat,
        translation=(float(x), float(y), placed.translation[2] - side * NEARER),
        rotation_degrees=(0.0, flat.rotation_degrees[1], math.degrees(angle)),
    )
