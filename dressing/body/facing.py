"""Recognition of the direction that a body faces, from its trunk and its feet."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from toile.dressing.body.avatar_sections import level_cut
from toile.geometry.arrays import Float, Int
from toile.geometry.connected import connected_vertices
from toile.geometry.normals import area_normals

TRUNK = np.linspace(0.5, 0.84, 18)
"""Levels at which the trunk is cut, in body heights: hips to shoulders."""
SOLE, ANKLE = 0.035, (0.07, 0.13)
"""Levels of a foot and of what stands on it, above its lowest point, in body heights."""
SHORTEST_FEET = 0.03
"""Feet whose soles lie together less than this ahead of the ankles point nowhere, in body heights: 0.07 to
0.12 on bodies from baby to giant."""
ROUND = 1.12
"""A trunk that is less than this times wider than deep has no wide side."""
SURE, UNSURE = 2.0, 15.0
"""Turns below this are none [degrees]: where feet and trunk agree, and where they do not."""
AGREE = 4.0
"""Feet and trunk agree if they differ by no more than this [degrees]."""
FRONTS = ("x", "-x", "y", "-y", "z", "-z")
"""Axes of a file that a body may be said to face."""


@dataclass(frozen=True, kw_only=True)
class Facing:
    """Where a body faces: angle about Y from +Z towards +X [degrees], and whether its front is known."""

    degrees: float
    sure: bool


def recognised_facing(vertices: Float, faces: Int) -> Facing:
    """Return where a body faces that is upright, Y up, vertices [m], shape (v, 3).

    Its trunk is wider than deep, and its toes point ahead. What differs from +Z by no more than the pose of
    a body makes it differ, or cannot be recognised, faces +Z. Quarter turns come out exactly.
    """
    vertices = vertices - vertices.mean(axis=0)
    height = float(np.ptp(vertices[:, 1]))
    toes = _toes(vertices, faces, height)
    across, width = _across(vertices, faces, height)
    long = float(np.linalg.norm(toes))
    if width < ROUND:
        if long < SHORTEST_FEET * height:
            return Facing(degrees=0.0, sure=False)
        return Facing(degrees=_settled(_angle(toes), UNSURE), sure=True)
    ahead = np.array([-across[1], across[0]])
    towards = float(ahead @ toes)
    # Toes that point sideways say nothing about front and back.
    if abs(towards) < max(SHORTEST_FEET * height, 0.5 * long):
        angle = _angle(ahead if ahead[1] >= 0.0 else -ahead)
        return Facing(degrees=_settled(angle, UNSURE), sure=False)
    ahead = ahead * np.sign(towards)
    apart = abs((_angle(toes) - _angle(ahead) + 180.0) % 360.0 - 180.0)
    return Facing(degrees=_settled(_angle(ahead), SURE if apart < AGREE else UNSURE), sure=True)


def _angle(direction: Float) -> float:
    """Angle of (x, z) from +Z towards +X [degrees]."""
    return float(np.degrees(np.arctan2(direction[0], direction[1])))


def _settled(degrees: float, least: float) -> float:
    """Return an angle, or the quarter turn that it differs from by no more than the pose makes it differ."""
    quarter = 90.0 * round(degrees / 90.0)
    if abs(degrees - quarter) > least:
        return degrees
    return 180.0 if quarter == -180.0 else quarter


def _across(vertices: Float, faces: Int, height: float) -> tuple[Float, float]:
    """Direction (x, z) in which the trunk is widest, and how much wider than deep it is."""
    low = float(vertices[:, 1].min())
    total = np.zeros((2, 2))
    for share in TRUNK:
        sections = level_cut(vertices, faces, low + share * height)
        if sections:
            total += _moments(sections[0].points[:, [0, 2]])
    sizes, axes = np.linalg.eigh(total)
    if sizes[1] <= 0.0:
        return np.array([1.0, 0.0]), 1.0
    return np.asarray(axes[:, 1]), float(np.sqrt(sizes[1] / max(sizes[0], 1e-12)))


def _moments(points: Float) -> Float:
    """Second moments of the convex hull of an outline (n, 2) about its centre, shape (2, 2)."""
    try:
        corners = points[ConvexHull(points).vertices]
    except (QhullError, ValueError):
        return np.zeros((2, 2))
    corners = corners - corners.mean(axis=0)
    after = np.roll(corners, -1, axis=0)
    twice = corners[:, 0] * after[:, 1] - after[:, 0] * corners[:, 1]
    area = 0.5 * float(twice.sum())
    centre = ((corners + after) * twice[:, None]).sum(axis=0) / (6.0 * area)
    both = corners + after
    second = np.einsum("n,ni,nj->ij", twice, corners, corners) + np.einsum("n,ni,nj->ij", twice, after, after)
    second += np.einsum("n,ni,nj->ij", twice, both, both)
    return np.asarray(second / 24.0 - area * np.outer(centre, centre))


def _toes(vertices: Float, faces: Int, height: float) -> Float:
    """Sum of the ways (x, z) [m] from ankles to soles, over all feet that stand."""
    level = vertices[:, 1] - vertices[:, 1].min()
    low = faces[(level[faces] < (ANKLE[1] + SOLE) * height).all(axis=1)]
    if not len(low):
        return np.zeros(2)
    used, local = np.unique(low, return_inverse=True)
    local = local.reshape(-1, 3)
    label = connected_vertices(local, len(used))
    corners = vertices[low]
    centres = corners.mean(axis=1)
    areas = np.linalg.norm(area_normals(corners), axis=1)
    foot_of = label[local[:, 0]]
    total = np.zeros(2)
    for foot in range(int(label.max()) + 1):
        own = foot_of == foot
        above = (centres[:, 1] - centres[own, 1].min()) / height
        sole, ankle = own & (above < SOLE), own & (above > ANKLE[0]) & (above < ANKLE[1])
        if areas[sole].sum() > 0.0 and areas[ankle].sum() > 0.0:
            total += np.average(centres[sole][:, [0, 2]], axis=0, weights=areas[sole])
            total -= np.average(centres[ankle][:, [0, 2]], axis=0, weights=areas[ankle])
    return total


def front_of_axis(axis: str, up: str) -> float:
    """Return the angle that a body faces [degrees], from an axis of its file such as "-y" and its up axis."""
    number, sign = "xyz".index(axis[-1]), -1.0 if axis.startswith("-") else 1.0
    if up == "z":
        # What points along y in the file points along -z here.
        number, sign = (0, sign) if number == 0 else (2, -sign)
    return {(0, 1.0): 90.0, (0, -1.0): -90.0, (2, 1.0): 0.0, (2, -1.0): 180.0}[number, sign]
