"""Verdicts on local mesh changes agree with FCL, and what is clear leaves the mesh free of crossings."""

import time
from collections.abc import Callable

import fcl
import numpy as np
import pytest
import trimesh

from tests.collide.surfaces import crumpled, sheet, stacked, vertices
from toile.collide import bvh
from toile.collide.audit import Auditor
from toile.collide.avatar_surface import AvatarSurface
from toile.collide.patch_clearance import PatchChanges, clear_proposals
from toile.collide.rigid_pieces import bvh_model
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.topology import triangle_topology

Change = tuple[list[list[int]], list[int]]
"""New triangles and removed faces of one proposal."""


Propose = Callable[[np.random.Generator, Int, int], PatchChanges]


def proposals(changes: list[Change]) -> PatchChanges:
    owner = [k for k, (new, _) in enumerate(changes) for _ in new]
    removed_owner = [k for k, (_, old) in enumerate(changes) for _ in old]
    triangles = np.array([t for new, _ in changes for t in new], np.int32).reshape(-1, 3)
    removed = np.array([t for _, old in changes for t in old], np.int32)
    return PatchChanges(
        triangles, np.array(owner, np.int32), removed, np.array(removed_owner, np.int32), len(changes)
    )


def flips(generator: np.random.Generator, faces: Int, limit: int) -> PatchChanges:
    """Flips of random inner edges; no face takes part twice."""
    topology = triangle_topology(faces)
    used: set[int] = set()
    changes: list[Change] = []
    for face in generator.permutation(len(faces)).tolist():
        k = int(generator.integers(3))
        other = int(topology.neighbours[face, k])
        if other < 0 or face in used or other in used or len(changes) == limit:
            continue
        used |= {face, other}
        a, u, v = (int(faces[face, (k + m) % 3]) for m in range(3))
        b = int(faces[other, topology.neighbour_sides[face, k]])
        changes.append(([[a, u, b], [a, b, v]], [face, other]))
    return proposals(changes)


def collapses(generator: np.random.Generator, faces: Int, limit: int) -> PatchChanges:
    """Random inner vertices moved to a neighbour; no face takes part twice."""
    outer = set(triangle_topology(faces).border_edges.ravel().tolist())
    used: set[int] = set()
    changes: list[Change] = []
    for node in generator.permutation(int(faces.max()) + 1).tolist():
        star = np.flatnonzero((faces == node).any(axis=1)).tolist()
        if node in outer or used & set(star) or len(changes) == limit:
            continue
        used |= set(star)
        ring = np.setdiff1d(faces[star], [node])
        target = int(generator.choice(ring))
        new = [np.where(faces[t] == node, target, faces[t]).tolist() for t in star if target not in faces[t]]
        changes.append((new, star))
    return proposals(changes)


def verdicts(
    x: Float, faces: Int, change: PatchChanges, *, weld: Int | None = None,
    avatar: AvatarSurface | None = None, gap: float = 1e-9,
) -> Bool:  # fmt: skip
    return clear_proposals(x, faces, vertices(len(x)) if weld is None else weld, change, avatar, gap, gap)


def carried_out(faces: Int, change: PatchChanges, chosen: Bool) -> Int:
    kept = np.delete(faces, change.removed[chosen[change.removed_owner]], axis=0)
    return np.ascontiguousarray(np.concatenate([kept, change.triangles[chosen[change.owner]]]))


def crossing_count(x: Float, faces: Int, avatar: AvatarSurface | None = None) -> int:
    body = (None, None) if avatar is None else (avatar.vertices, avatar.faces)
    found = Auditor(*body).audit(x, faces, vertices(len(x)))
    return len(found.cloth) + len(found.avatar)


def model(x: Float, faces: Int) -> fcl.CollisionObject:
    return fcl.CollisionObject(bvh_model(x, np.ascontiguousarray(faces)), fcl.Transform())


def expected(x: Float, faces: Int, change: PatchChanges, gap: float) -> Bool:
    """The same verdicts by FCL: every proposal carried out beside those that were found clear before it."""
    clear = np.zeros(change.total, bool)
    for k in range(change.total):
        kept = np.delete(faces, change.removed[change.removed_owner == k], axis=0)
        others = np.concatenate([kept, change.triangles[clear[change.owner]]])
        own = change.triangles[change.owner == k]
        crossing = Auditor(None, None).audit(x, np.concatenate([others, own]), vertices(len(x))).cloth
        clear[k] = not (crossing >= len(others)).any()
        for triangle in own:
            apart = others[~np.isin(others, triangle).any(axis=1)]
            distance = fcl.distance(model(x, triangle[None]), model(x, apart))
            clear[k] &= distance >= gap
    return clear


def folded_strip(generator: np.random.Generator, count: int) -> tuple[Float, Int]:
    """One rough cloth [m] in two layers 0.5 mm apart that are joined along one side."""
    x, faces = sheet(count, 0.01)
    x[:, 1] = 0.0006 * generator.normal(size=len(x))
    x, both = stacked([(x, faces), (x + np.array([0.0, 0.0005, 0.0]), faces)])
    a = np.arange(count - 1, dtype=np.int32)
    b = a + np.int32(count * count)
    join = np.concatenate([np.column_stack([a, a + 1, b]), np.column_stack([a + 1, b + 1, b])])
    turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
    return np.ascontiguousarray(x @ turn.T), np.ascontiguousarray(np.concatenate([both, join]), np.int32)


@pytest.mark.parametrize("gap", [1e-9, 5e-4])
@pytest.mark.parametrize("propose", [flips, collapses])
@pytest.mark.parametrize("seed", range(4))
def test_verdicts_on_crumpled_cloth_agree_with_fcl(seed: int, propose: Propose, gap: float) -> None:
    generator = np.random.default_rng(seed)
    x, faces = crumpled(generator, 9, 0.02, 0.6)
    change = propose(generator, faces, 30)
    found = verdicts(x, faces, change, gap=gap)
    np.testing.assert_array_equal(found, expected(x, faces, change, gap))
    assert 0 < found.sum() < change.total


@pytest.mark.parametrize("seed", range(3))
def test_clear_changes_of_a_folded_strip_leave_it_free_of_crossings(seed: int) -> None:
    generator = np.random.default_rng(seed)
    x, faces = folded_strip(generator, 12)
    assert crossing_count(x, faces) == 0
    for propose in (flips, collapses):
        change = propose(generator, faces, 60)
        found = verdicts(x, faces, change)
        np.testing.assert_array_equal(found, expected(x, faces, change, 1e-9))
        assert 5 < found.sum() < change.total
        assert crossing_count(x, carried_out(faces, change, found)) == 0
        assert crossing_count(x, carried_out(faces, change, np.ones(change.total, bool))) > 0


def test_repeated_changes_of_a_folded_strip_keep_it_free_of_crossings() -> None:
    generator = np.random.default_rng(11)
    x, faces = folded_strip(generator, 14)
    for _ in range(12):
        change = flips(generator, faces, 80)
        faces = carried_out(faces, change, verdicts(x, faces, change))
        assert crossing_count(x, faces) == 0


@pytest.mark.parametrize("seed", range(3))
def test_clear_changes_around_a_body_do_not_cut_it(seed: int) -> None:
    """Cloth on a sphere, about 1 mm off: a collapsed edge leaves a chord that may pass through the body."""
    generator = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
    points, faces = np.array(ball.vertices), np.array(ball.faces, np.int32)
    avatar = AvatarSurface(points, faces)
    x = points * (1.0 + 0.01 * generator.uniform(0.6, 1.6, size=(len(points), 1)))
    assert crossing_count(x, faces, avatar) == 0
    change = collapses(generator, faces, 30)
    found = verdicts(x, faces, change, avatar=avatar)
    assert 0 < found.sum() < change.total
    for k in range(change.total):
        alone = np.arange(change.total) == k
        assert found[k] == (crossing_count(x, carried_out(faces, change, alone), avatar) == 0)
    assert crossing_count(x, carried_out(faces, change, found), avatar) == 0
    roomy = verdicts(1.02 * x, faces, change, avatar=avatar)
    assert roomy.all()
    avatar.move_to(1.02 * points)
    np.testing.assert_array_equal(verdicts(1.02 * x, faces, change, avatar=avatar), found)
    # The gap to the body is its own.
    near = clear_proposals(1.02 * x, faces, vertices(len(x)), change, avatar, 1e-9, 0.0005)
    assert near.sum() < found.sum()


@pytest.mark.parametrize("seed", range(10))
def test_flat_cloth_may_change_however_it_is_turned(seed: int) -> None:
    generator = np.random.default_rng(seed)
    x, faces = crumpled(generator, 12, 0.01, 0.0)
    for change in (flips(generator, faces, 60), collapses(generator, faces, 20)):
        # The regular grid makes some flips flat: three nodes in a line.
        corners = x[change.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        flat = np.zeros(change.total, bool)
        flat[change.owner[np.linalg.norm(normal, axis=1) < 1e-9]] = True
        kept = carried_out(faces, change, ~flat)
        found = verdicts(x, faces, change, gap=1e-4)
        np.testing.assert_array_equal(found, ~flat)
        assert crossing_count(x, kept) == 0


def test_folding_over_at_shared_nodes_is_refused() -> None:
    # The quad 0 1 2 3 has an inward corner at 3: its other diagonal runs outside.
    x = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1), (0.2, 0, 0.2)], float)
    faces = np.array([(0, 1, 3), (0, 3, 2)], np.int32)
    change = proposals([([[0, 1, 2], [1, 2, 3]], [0, 1])])
    assert not verdicts(x, faces, change)[0]
    # One shared node: the far edge of the new triangle passes through the kept one.
    x = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1), (0.5, 0.5, 0.5), (0.5, -0.5, 0.4), (0.5, 0.1, 0.4)], float)
    kept = np.array([(0, 1, 2)], np.int32)
    for one, other in (([0, 1, 2], [0, 3, 4]), ([0, 3, 4], [0, 1, 2])):
        for turn in range(9):
            first = np.roll(one, turn % 3)[None].astype(np.int32)
            assert not verdicts(x, first, proposals([([np.roll(other, turn // 3).tolist()], [])]))[0]
    assert verdicts(x, kept, proposals([([[0, 3, 5]], [])]))[0]
    # The edge from the shared node passes exactly through the far edge of the kept one.
    x = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1), (0.7, 0, 0.7), (0.5, 0.5, 0.4)], float)
    assert not verdicts(x, kept, proposals([([[0, 3, 4]], [])]))[0]


@pytest.mark.parametrize(("angle", "clear"), [(0.0, False), (5e-4, False), (2e-3, True), (3.0, True)])
def test_triangles_at_a_shared_edge_lie_on_each_other_below_the_fold_angle(angle: float, clear: bool) -> None:
    x = np.array([(0, 0, 0), (1, 0, 0), (0.4, 0, 1), (0.5, 0.8 * np.sin(angle), 0.8 * np.cos(angle))], float)
    kept = np.array([(0, 1, 2)], np.int32)
    assert verdicts(x, kept, proposals([([[1, 0, 3]], [])]))[0] == clear


def test_a_face_that_exists_already_is_refused() -> None:
    x, faces = sheet(3, 0.01)
    assert not verdicts(x, faces, proposals([([faces[4][::-1].tolist()], [])]))[0]


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_of_two_changes_that_meet_only_each_other_the_first_is_clear(order: tuple[int, int]) -> None:
    # Two saddles face each other; each flip moves one centre 0.3 towards the other, 0.5 away.
    low = np.array([(-1, 0, 0), (1, 0, 0), (0, 0.3, -1), (0, 0.3, 1)])
    x = np.concatenate([low, low[:, [2, 1, 0]] * [1, -1, 1] + [0, 0.5, 0]])
    faces = np.array([(0, 1, 2), (1, 0, 3), (4, 5, 6), (5, 4, 7)], np.int32)
    changes = [([[2, 3, 0], [3, 2, 1]], [0, 1]), ([[6, 7, 4], [7, 6, 5]], [2, 3])]
    both = proposals([changes[k] for k in order])
    assert verdicts(x, faces, both, gap=0.01).tolist() == [True, False]
    for change in changes:
        assert verdicts(x, faces, proposals([change]), gap=0.01).all()
    assert crossing_count(x, carried_out(faces, both, np.ones(2, bool))) > 0


def test_a_refused_change_refuses_no_other() -> None:
    x, faces = sheet(4, 0.01)
    first = flips(np.random.default_rng(0), faces, 1)
    new, old = first.triangles.tolist(), first.removed.tolist()
    # The same flip twice; the first one keeps the old faces and lies on them.
    assert verdicts(x, faces, proposals([(new, []), (new, old)])).tolist() == [False, True]


def test_gap_between_layers() -> None:
    generator = np.random.default_rng(2)
    x, faces = crumpled(generator, 8, 0.01, 0.0)
    normal = np.cross(x[1] - x[0], x[8] - x[0])
    x, faces = stacked([(x, faces), (x + 5e-4 * normal / np.linalg.norm(normal), faces)])
    change = proposals([([[0, 1, 9], [0, 9, 8]], [0, 49])])
    assert sorted(set(faces[[0, 49]].ravel().tolist())) == [0, 1, 8, 9]
    assert verdicts(x, faces, change, gap=4.9e-4).all()
    assert not verdicts(x, faces, change, gap=5.1e-4).any()


@pytest.mark.parametrize(
    "meeting",
    {
        "edges close": [(-1, 0, 0), (1, 0, 0), (0, -1, 0.1), (0, 5e-4, -1), (0, 5e-4, 1), (0.1, 1, 0)],
        "vertex over face": [(-1, 0, -1), (2, 0, -1), (-1, 0, 2), (0, 5e-4, 0), (0.2, 1, 0), (0, 1, 0.2)],
        "edge through face": [(-1, 0, -1), (2, 0, -1), (-1, 0, 2), (0, 1, 0), (0, -1, 0), (9, 1, 9)],
    }.values(),
)
def test_every_corner_and_edge_is_tested(meeting: list[tuple[float, float, float]]) -> None:
    x = np.array(meeting, float)
    for one, other in (([0, 1, 2], [3, 4, 5]), ([3, 4, 5], [0, 1, 2])):
        for turn in range(9):
            kept = np.roll(one, turn % 3)[None].astype(np.int32)
            change = proposals([([np.roll(other, turn // 3).tolist()], [])])
            assert not verdicts(x, kept, change, gap=1e-3)[0]
            apart = x + np.repeat([[0.0, 0.0, 0.0], [0.0, 2.0, 0.0]], 3, axis=0)
            assert verdicts(apart, kept, change, gap=1e-3)[0]


def test_touching_without_a_shared_node_is_refused_even_with_no_gap() -> None:
    x = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1), (0.3, 0, 0.3), (0.3, 1, 0.3), (0.6, 1, 0.3)])
    kept, change = np.array([(0, 1, 2)], np.int32), proposals([([[3, 4, 5]], [])])
    assert not verdicts(x, kept, change, gap=0.0)[0]
    x[3:, 1] += 1e-4
    assert verdicts(x, kept, change, gap=0.0)[0]


@pytest.mark.parametrize("seed", range(4))
def test_welded_nodes_count_as_one(seed: int) -> None:
    """Every corner of every face with a node of its own gives the verdicts of the joined mesh."""
    generator = np.random.default_rng(seed)
    x, faces = crumpled(generator, 8, 0.02, 0.6)
    change = flips(generator, faces, 25)
    whole = verdicts(x, faces, change)
    corners = np.concatenate([faces, change.triangles]).ravel()
    weld = np.unique(corners, return_index=True)[1][np.searchsorted(np.unique(corners), corners)]
    loose = vertices(len(corners)).reshape(-1, 3)
    apart = change._replace(triangles=loose[len(faces) :])
    points = np.ascontiguousarray(x[corners])
    split = verdicts(points, loose[: len(faces)], apart, weld=weld.astype(np.int32))
    np.testing.assert_array_equal(split, whole)
    assert 0 < whole.sum() < change.total


@pytest.mark.parametrize("sewn", [2, 3])
def test_triangles_that_face_each_other_across_an_open_seam_are_no_fold(sewn: int) -> None:
    """The same triangle twice, side by side in one plane, with two or all corners to be sewn."""
    x = np.array([(0, 0, 0), (0, 0, 1), (0.1, 0, 0.5)], float)
    x = np.concatenate([x, x + np.array([0.2, 0.0, 0.0])])
    weld = vertices(6)
    weld[3 : 3 + sewn] = weld[:sewn]
    kept = np.array([(0, 1, 2)], np.int32)
    assert verdicts(x, kept, proposals([([[3, 4, 5]], [])]), weld=weld, gap=0.3)[0]
    x[3:] -= np.array([0.2, 0.0, 0.0])
    assert not verdicts(x, kept, proposals([([[3, 4, 5]], [])]), weld=weld, gap=0.3)[0]


def test_removed_faces_are_ignored_by_their_own_change_only() -> None:
    x, faces = sheet(4, 0.01)
    change = flips(np.random.default_rng(1), faces, 1)
    assert verdicts(x, faces, change).all()
    empty = np.empty(0, np.int32)
    assert not verdicts(x, faces, change._replace(removed=empty, removed_owner=empty)).any()
    other = change._replace(removed_owner=np.ones(2, np.int32), total=2)
    assert verdicts(x, faces, other).tolist() == [False, True]


def test_nothing_is_built_for_an_empty_list(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bvh, "build", None)
    x, faces = sheet(4, 0.01)
    avatar = AvatarSurface(x, faces)
    assert verdicts(x, faces, proposals([]), avatar=avatar).shape == (0,)
    assert verdicts(x, faces, proposals([([], [0])]), avatar=avatar).tolist() == [True]


def test_many_changes_of_a_large_mesh_take_milliseconds() -> None:
    """20,000 faces, 500 flips: 26 ms here; the bound only excludes a search of all pairs."""
    generator = np.random.default_rng(0)
    x, faces = sheet(101, 0.01)
    x[:, 1] = 0.05 * np.sin(8 * x[:, 0]) * np.cos(6 * x[:, 2])
    change = flips(generator, faces, 500)
    times = []
    for _ in range(5):
        start = time.perf_counter()
        verdicts(x, faces, change)
        times.append(time.perf_counter() - start)
    assert min(times) < 0.5
