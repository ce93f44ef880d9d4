"""Untangling: the direction is the steepest fall of the crossing curve's length, and tangles come loose."""

import numpy as np
import pytest

from toile.collide.audit import crossings_within
from toile.engine.forces.step_request import StepRequest
from toile.engine.forces.untangle import Untangling
from toile.engine.step.state import Instant
from toile.geometry.arrays import Float, Int

STIFFNESS = 50.0


def grid(columns: int, rows: int, size: float) -> tuple[Float, Int]:
    """A flat sheet in the plane z = 0, centred."""
    u, v = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="xy")
    x = np.stack([size * (u - columns / 2), size * (v - rows / 2), 0.0 * u], axis=-1).reshape(-1, 3)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)[None, :]).ravel()
    above = corner + columns + 1
    faces = np.concatenate(
        [np.stack([corner, corner + 1, above + 1], 1), np.stack([corner, above + 1, above], 1)]
    )
    return x, faces.astype(np.int32)


def pair(bump: Float) -> tuple[Float, Int]:
    """A flat sheet of 1 cm triangles, and a second one below it lifted by `bump` over its nodes."""
    low, faces = grid(12, 12, 0.01)
    high = low + np.array([0.0013, 0.0007, 0.0])
    low = low + np.stack([0.0 * bump, 0.0 * bump, bump], axis=1)
    return np.concatenate([high, low]), np.concatenate([faces, faces + np.int32(len(low))])


def curve_length(x: Float, faces: Int) -> float:
    """Length of the curves along which faces cross, from the planes of each pair."""
    total = 0.0
    for one, two in crossings_within(x, faces, np.arange(len(x), dtype=np.int32)):
        ends = []
        for a, b in ((one, two), (two, one)):
            corners, other = x[faces[a]], x[faces[b]]
            normal = np.cross(other[1] - other[0], other[2] - other[0])
            height = (corners - other[0]) @ normal
            for k in range(3):
                h0, h1 = height[k], height[(k + 1) % 3]
                if h0 * h1 < 0.0:
                    place = corners[k] + h0 / (h0 - h1) * (corners[(k + 1) % 3] - corners[k])
                    weights = np.linalg.lstsq(
                        np.stack([other[1] - other[0], other[2] - other[0]], 1), place - other[0], rcond=None
                    )[0]
                    if (weights >= 0.0).all() and weights.sum() <= 1.0:
                        ends.append(place)
        if len(ends) == 2:
            total += float(np.linalg.norm(ends[0] - ends[1]))
    return total


def bump(height: float) -> Float:
    place, _ = grid(12, 12, 0.01)
    return np.asarray(-0.004 + height * np.exp(-(place[:, 0] ** 2 + place[:, 1] ** 2) / 0.02**2))


def untangling(x: Float, faces: Int, cloth_nodes: int) -> Untangling:
    """The springs as they are at x in a step of that stiffness."""
    springs = Untangling(faces, np.arange(len(x), dtype=np.int32), cloth_nodes, x)
    request = StepRequest(h=0.01, at_rest=True, untangle_stiffness=STIFFNESS)
    assert springs.begin(Instant(request, np.zeros_like(x), x), x[:cloth_nodes])
    springs.evaluate(x)
    return springs


def forces(x: Float, faces: Int) -> tuple[Untangling, Float]:
    springs = untangling(x, faces, len(x))
    gradient = np.zeros_like(x)
    springs.add_gradient(x, gradient)
    return springs, -gradient


def test_a_step_along_the_forces_shortens_the_curve() -> None:
    x, faces = pair(bump(0.02))
    _, force = forces(x, faces)
    before = curve_length(x, faces)
    assert before > 0.05
    after = curve_length(x + 1e-4 * force / np.abs(force).max(), faces)
    against = curve_length(x - 1e-4 * force / np.abs(force).max(), faces)
    assert after < before < against


def test_forces_are_in_balance() -> None:
    x, faces = pair(bump(0.02))
    springs, force = forces(x, faces)
    assert len(springs.ends)
    assert force.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
    assert springs.weights.sum(axis=1) == pytest.approx(1.0)


def test_nothing_crosses_nothing_is_drawn() -> None:
    x, faces = pair(bump(0.002))
    springs, force = forces(x, faces)
    assert len(springs.ends) == 0 and not force.any()
    assert len(springs.stencils().nodes) == 0


def test_avatar_vertices_are_pushed_against_but_do_not_move() -> None:
    x, faces = pair(bump(0.02))
    count = len(x) // 2
    springs = untangling(x, faces, count)
    assert springs.ends.max() < count
    gradient = np.zeros((count, 3))
    springs.add_gradient(x[:count], gradient)
    assert gradient.any()


def test_where_only_the_avatar_crosses_itself_there_are_no_springs() -> None:
    x, faces = pair(bump(0.02))
    springs = untangling(x, faces, 0)
    assert len(springs.ends) == 0


def test_a_bump_that_pokes_through_is_drawn_back() -> None:
    x, faces = pair(bump(0.012))
    edges = np.unique(
        np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1), axis=0
    )
    for _ in range(400):
        _, force = forces(x, faces)
        if not force.any():
            break
        x = x + 2e-3 * force / STIFFNESS / 1e-3 * 0.25
        # A little smoothing stands for stretch and bending.
        mean = np.zeros_like(x)
        for a, b in ((0, 1), (1, 0)):
            np.add.at(mean, edges[:, a], x[edges[:, b]])
        x = 0.98 * x + 0.02 * mean / np.bincount(edges.ravel())[:, None]
    assert len(crossings_within(x, faces, np.arange(len(x), dtype=np.int32))) == 0
