"""The audit counts exactly the crossing face pairs."""

import numpy as np
import pytest

from tests.collide.rational_triangles import crossing_between, crossing_in_rationals
from tests.collide.surfaces import crumpled, sheet, stacked
from toile.collide.audit import Auditor
from toile.geometry.arrays import Float, Int


def as_set(pairs: Int) -> set[tuple[int, int]]:
    found = {(int(a), int(b)) for a, b in pairs}
    assert len(found) == len(pairs)
    return found


def unsewn(positions: Float) -> Int:
    return np.arange(len(positions), dtype=np.int32)


@pytest.mark.parametrize("seed", range(4))
def test_counts_are_exact(seed: int) -> None:
    generator = np.random.default_rng(seed)
    x, faces = stacked([crumpled(generator, 5, 0.02, 0.35) for _ in range(2)])
    body, body_faces = crumpled(generator, 5, 0.02, 0.2)
    found = Auditor(body, body_faces).audit(x, faces, unsewn(x))
    assert as_set(found.avatar) == crossing_between(x, faces, body, body_faces)
    assert as_set(found.cloth) == crossing_in_rationals(x, faces)
    assert len(found.avatar) > 5 and len(found.cloth) > 5


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9])
def test_close_layers_do_not_cross(gap: float) -> None:
    flat, faces = sheet(6, 0.02)
    over = flat + np.array([0.003, gap, 0.005])
    x, both = stacked([(flat, faces), (over, faces)])
    found = Auditor(flat - np.array([0.001, gap, 0.002]), faces).audit(x, both, unsewn(x))
    assert len(found.avatar) == 0 and len(found.cloth) == 0
    poked = x.copy()
    poked[36 + 14, 1] = -0.3 * gap
    assert (
        as_set(Auditor(None, None).audit(poked, both, unsewn(x)).cloth)
        == crossing_in_rationals(poked, both)
        != set()
    )


def test_neighbours_touch_but_do_not_count() -> None:
    """Flat, sharply folded, crumpled: sharing a corner or an edge is no crossing."""
    generator = np.random.default_rng(0)
    auditor = Auditor(None, None)
    flat, faces = sheet(7, 0.02)
    assert len(auditor.audit(flat, faces, unsewn(flat)).cloth) == 0
    for angle in (0.5, 1.5, 3.0, 3.13):
        folded = flat.copy()
        across = np.maximum(flat[:, 0] - 0.06, 0.0)
        folded[:, 0] += across * (np.cos(angle) - 1.0)
        folded[:, 1] += across * np.sin(angle)
        assert len(auditor.audit(folded, faces, unsewn(flat)).cloth) == 0
    for _ in range(20):
        turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
        rough = flat + np.array([0.0, 0.004, 0.0]) * generator.normal(size=flat.shape)
        rough = np.ascontiguousarray(rough @ turn.T + generator.normal(size=3))
        assert len(auditor.audit(rough, faces, unsewn(flat)).cloth) == 0


def test_neighbours_folded_through_each_other_count() -> None:
    # Two faces that share corner 0; the second passes through the first.
    x = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1), (0.5, 0.5, 0.5), (0.5, -0.5, 0.4)], float)
    faces = np.array([(0, 1, 2), (0, 3, 4)], np.int32)
    auditor = Auditor(None, None)
    assert as_set(auditor.audit(x, faces, unsewn(x)).cloth) == {(0, 1)}
    # By a hair's breadth, from either side.
    for depth in (1e-6, -1e-6, 1e-9, -1e-9):
        x = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1), (0.5, depth, 0.2), (0.3, -depth, 0.3)], float)
        assert as_set(auditor.audit(x, faces, unsewn(x)).cloth) == {(0, 1)}


def test_open_seams_do_not_count_until_they_are_sewn() -> None:
    flat, faces = sheet(3, 0.02)
    other = flat * np.array([-1.0, 1.0, 1.0]) + np.array([0.015, 0.0, 0.0])
    other[:, 1] = 0.1 * (other[:, 0] - 0.006) + 0.01 * other[:, 2]
    x, both = stacked([(flat, faces), (other, faces)])
    apart = Auditor(None, None).audit(x, both, unsewn(x))
    assert as_set(apart.cloth) == crossing_in_rationals(x, both) != set()
    # The columns at x = 0 are to be sewn: only the pairs along that seam may overlap.
    weld = unsewn(x)
    weld[9:12] = weld[0:3]
    sewn = as_set(Auditor(None, None).audit(x, both, weld).cloth)
    nodes = [set(weld[face].tolist()) for face in both]
    assert sewn == {(i, j) for i, j in as_set(apart.cloth) if not nodes[i] & nodes[j]}
    assert sewn != as_set(apart.cloth)
    # Faces on the same side of the seam that share a node count as always.
    y = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1), (0.5, 0.5, 0.5), (0.5, -0.5, 0.4)], float)
    through = np.array([(0, 1, 2), (0, 3, 4)], np.int32)
    assert len(Auditor(None, None).audit(y, through, np.array([0, 1, 2, 3, 4], np.int32)).cloth) == 1


def test_cloth_that_wanders_over_an_avatar_meets_it_wherever_it_gets() -> None:
    generator = np.random.default_rng(5)
    body, body_faces = crumpled(generator, 14, 0.04, 0.2)
    patch, faces = crumpled(generator, 4, 0.02, 0.35)
    auditor = Auditor(body, body_faces)
    for place in (*body[::65], 3.0 * body[0]):
        x = patch + place
        found = as_set(auditor.audit(x, faces, unsewn(x)).avatar)
        assert found == crossing_between(x, faces, body, body_faces)
        assert found or (place == 3.0 * body[0]).all()
