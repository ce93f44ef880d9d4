"""The built-in mannequin: a standing figure made to measure."""

import manifold3d
import numpy as np
from scipy.sparse import coo_matrix, diags_array
from scipy.spatial import ConvexHull

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.mannequin_figure import (
    CHEST_LEVELS,
    HIP_LEVELS,
    WAIST_LEVELS,
    Build,
    figure_distance,
)
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

EDGE_LENGTH = 0.015
"""Length of the mannequin's edges [m]."""

HEIGHTS = (1.0, 2.1)
"""Heights that can be built [m]."""

GIRTHS = {"chest": (0.40, 0.85), "waist": (0.30, 0.85), "hip": (0.42, 0.85)}
"""Girths that can be built, as fractions of the height."""

GIRTH_TOLERANCE = 0.002
"""Relative error of a girth at which the fit of the cross-sections stops."""


def mannequin(*, height: float = 1.70, chest: float = 0.92, waist: float = 0.74, hip: float = 0.98) -> Avatar:
    """Return a standing figure in A-pose with the given height and girths [m].

    Feet on the floor (y = 0), facing +Z, arms 45 degrees below the horizontal, legs apart. One watertight
    surface of genus 0 without self-crossings; the same arguments give the same bytes.
    Raises InputError naming the measurement that no figure could have.
    """
    _check(height, chest, waist, hip)
    build = _fitted_build(chest / height, waist / height, hip / height)
    # Edges of a child's figure shrink with it: fingers and feet keep their shape.
    vertices, faces = _polygonise(build, EDGE_LENGTH / max(height, 1.5))
    vertices = vertices * (height / np.ptp(vertices[:, 1]))
    vertices[:, 1] -= vertices[:, 1].min()
    return Avatar(
        name="mannequin",
        vertices=np.ascontiguousarray(vertices),
        faces=faces,
        placed=True,
        repaired=True,
        notes=(
            f"Built-in mannequin: height {height:.3g} m, chest {chest:.3g} m, waist {waist:.3g} m, "
            f"hip {hip:.3g} m.",
        ),
    )


def _check(height: float, chest: float, waist: float, hip: float) -> None:
    """Raise InputError unless a figure can have these measurements [m]."""
    if not HEIGHTS[0] <= height <= HEIGHTS[1]:
        raise InputError(
            f"mannequin: height must be {HEIGHTS[0]:.1f} to {HEIGHTS[1]:.1f} m, got {height:g} (metres?)",
            field="height",
        )
    for name, girth in (("chest", chest), ("waist", waist), ("hip", hip)):
        low, high = (fraction * height for fraction in GIRTHS[name])
        if not low <= girth <= high:
            raise InputError(
                f"mannequin: {name} of a figure {height:g} m tall must be {low:.2f} to {high:.2f} m, "
                f"got {girth:g} (metres?)",
                field=name,
            )
    if not 0.55 <= waist / min(chest, hip) <= 1.4 or not 0.65 <= chest / hip <= 1.45:
        raise InputError(
            f"mannequin: chest {chest:g}, waist {waist:g} and hip {hip:g} m do not fit one figure; "
            "give girths nearer to each other"
        )


def _fitted_build(chest: float, waist: float, hip: float) -> Build:
    """Scale the cross-sections until their convex girths are those asked for (all in heights)."""
    wanted = np.array([chest, waist, hip])
    factors = np.ones(3)
    for _ in range(30):
        build = Build(chest=factors[0], waist=factors[1], hip=factors[2])
        girths = np.array(
            [
                max(_girth(level, build) for level in CHEST_LEVELS),
                min(_girth(level, build) for level in WAIST_LEVELS),
                max(_girth(level, build) for level in HIP_LEVELS),
            ]
        )
        if (np.abs(girths / wanted - 1.0) < GIRTH_TOLERANCE).all():
            break
        factors *= wanted / girths
    return build


def _girth(level: float, build: Build) -> float:
    """Convex girth of the figure's trunk at a height above the floor, both in heights."""
    angles = np.linspace(0.0, np.pi, 61)
    radii = np.linspace(0.02, 0.30, 71)
    centre = 0.005
    x = np.sin(angles)[:, None] * radii
    z = centre + np.cos(angles)[:, None] * radii
    points = np.stack([x, np.full_like(x, level), z], axis=-1)
    distance = figure_distance(points.reshape(-1, 3), build).reshape(x.shape)
    # First sample outside along each ray, then linear interpolation back to the surface.
    outside = np.maximum(np.argmax(distance > 0.0, axis=1), 1)
    rows = np.arange(len(angles))
    before, after = distance[rows, outside - 1], distance[rows, outside]
    share = before / (before - after)
    radius = radii[outside - 1] + share * (radii[outside] - radii[outside - 1])
    half = np.column_stack([np.sin(angles) * radius, np.cos(angles) * radius])
    outline = np.concatenate([half, half * (-1.0, 1.0)])
    return float(ConvexHull(outline).area)


def _polygonise(build: Build, edge_length: float) -> tuple[Float, Int]:
    """Vertices and faces of the figure's surface, all in heights, with edges about `edge_length` long."""
    reach = 0.45 + 0.10 * max(build.chest - 1.0, 0.0)
    depth = 0.13 * max(1.0, build.chest, build.waist, build.hip)
    bounds = (-reach, -0.02, -depth, reach, 1.02, depth)
    # The mesher's lattice gives edges of about 0.69 of its spacing.
    spacing = edge_length / 0.69
    queried: list[tuple[float, float, float]] = []

    def outside(x: float, y: float, z: float) -> float:
        queried.append((x, y, z))
        return -1.0

    # The mesher asks for one point at a time; a dry run tells which, so that all are evaluated at once.
    manifold3d.Manifold.level_set(outside, bounds, spacing)
    inside = -figure_distance(np.array(queried), build)
    values = dict(zip(queried, inside.tolist(), strict=True))

    def value(x: float, y: float, z: float) -> float:
        known = values.get((x, y, z))
        return -float(figure_distance(np.array([[x, y, z]]), build)[0]) if known is None else known

    mesh = manifold3d.Manifold.level_set(value, bounds, spacing).to_mesh64()
    vertices = np.ascontiguousarray(mesh.vert_properties[:, :3], dtype=np.float64)
    faces = np.ascontiguousarray(mesh.tri_verts, dtype=np.int32)
    return _relaxed(vertices, faces, build), faces


def _relaxed(vertices: Float, faces: Int, build: Build, rounds: int = 12) -> Float:
    """Even out the triangles: vertices slide towards their neighbours' mean, then back on the surface."""
    count = len(vertices)
    rows, columns = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    links = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(count, count)).tocsr()
    mean = diags_array(1.0 / np.asarray(links.sum(axis=1)).ravel()) @ links
    for _ in range(rounds):
        vertices = _on_surface(vertices + 0.5 * (mean @ vertices - vertices), build)
    return _on_surface(vertices, build)


def _on_surface(vertices: Float, build: Build) -> Float:
    """One Newton step of every vertex along the gradient onto the surface."""
    step = 1e-5
    gradient = np.column_stack(
        [
            figure_distance(vertices + step * axis, build) - figure_distance(vertices - step * axis, build)
            for axis in np.eye(3)
        ]
    ) / (2.0 * step)
    squared = np.maximum((gradient * gradient).sum(axis=1), 0.1)
    return np.ascontiguousarray(vertices - (figure_distance(vertices, build) / squared)[:, None] * gradient)
