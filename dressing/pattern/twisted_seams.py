"""Seams that are sewn the wrong way round: found before anything is sewn, since they never close."""

from collections import deque

import numpy as np

from toile.dressing.pattern.pattern import Pattern, Stitch
from toile.dressing.pattern.pattern_outline import edge_ends
from toile.geometry.errors import InputError

SHORTER = 0.75
"""A seam may be twisted whose ends lie closer by this factor when it is sewn the other way round."""
CROSSED = 0.6
"""The ends must come closer by this share of the seam's length as well."""


def check_twists(pattern: Pattern) -> None:
    """Raise InputError naming a seam that twists its panels."""
    found = twisted_seam(pattern)
    if found is None:
        return
    stitch, why = found
    number = pattern.stitches.index(stitch)
    remedy = 'remove "right_wrong" from it' if stitch.right_wrong else 'turn it round (add "right_wrong")'
    raise InputError(
        f"{pattern.name}: stitch {number} ({stitch.name}) twists: {why}; {remedy}",
        field=f"pattern.stitches.{number}",
    )


def twisted_seam(pattern: Pattern) -> tuple[Stitch, str] | None:
    """Return a seam that twists its panels, and why it does, or None.

    Two kinds are found: a seam that sews right sides to wrong ones where the other seams say otherwise (a
    strip with a half turn, which has no right side), and one whose ends lie crosswise where panels start.
    """
    odd = _odd_seam(pattern)
    if odd is not None:
        return odd, "the other seams sew these panels right side to right side"
    for stitch in pattern.stitches:
        now, turned, length = _end_distances(pattern, stitch)
        if turned < SHORTER * now and now - turned > CROSSED * length:
            return stitch, "its ends lie crosswise where the panels are placed"
    return None


def _odd_seam(pattern: Pattern) -> Stitch | None:
    """Return a seam at odds with others about which sides of two panels are the right ones, or None.

    Of the seams that close a contradicting circle it is the one that fits its panels' places the worst.
    """
    side: dict[str, bool] = {}
    came_by: dict[str, Stitch] = {}
    suspects: list[Stitch] = []
    for root in pattern.panels:
        if root.name in side:
            continue
        side[root.name] = False
        waiting = deque([root.name])
        while waiting:
            name = waiting.popleft()
            for stitch in pattern.stitches:
                other = stitch.partner(name)
                if other is None:
                    continue
                wanted = side[name] ^ stitch.right_wrong
                if other not in side:
                    side[other], came_by[other] = wanted, stitch
                    waiting.append(other)
                elif side[other] != wanted:
                    suspects += [stitch, *(came_by[panel] for panel in (name, other) if panel in came_by)]
    if not suspects:
        return None

    def gain(stitch: Stitch) -> float:
        now, turned, _ = _end_distances(pattern, stitch)
        return now - turned

    return max(suspects, key=gain)


def _end_distances(pattern: Pattern, stitch: Stitch) -> tuple[float, float, float]:
    """Sum of the distances of ends that meet [m], the same if it were turned round, and the seam's length."""
    first = edge_ends(pattern.panel(stitch.panel_a), stitch.edge_a)
    second = edge_ends(pattern.panel(stitch.panel_b), stitch.edge_b)
    # Panels that lie beyond all reason are named where their places are checked.
    with np.errstate(over="ignore"):
        straight = float(np.linalg.norm(first - second, axis=1).sum())
        turned = float(np.linalg.norm(first - second[::-1], axis=1).sum())
    length = min(float(np.linalg.norm(end[1] - end[0])) for end in (first, second))
    return (straight, turned, length) if stitch.right_wrong else (turned, straight, length)
