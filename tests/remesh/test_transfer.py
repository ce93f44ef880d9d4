"""Data follow the mesh: attributes, marks, indices, momentum."""

import numpy as np

from tests.remesh.cloth_samples import random_delaunay, ridge, right_grid, sewn_panels, uniform
from toile.geometry.arrays import Float
from toile.remesh.adapt.adapt import AdaptResult, adapt
from toile.remesh.adapt.momentum import Motion, with_momentum_of
from toile.remesh.mesh.cloth_mesh import ClothMesh


def lumped_mass(mesh: ClothMesh) -> Float:
    third = np.repeat(0.2 * mesh.rest_area / 3.0, 3)
    return np.asarray(np.bincount(mesh.face_nodes.ravel(), weights=third, minlength=len(mesh.positions)))


def test_attributes_of_any_width_follow() -> None:
    mesh = random_delaunay(8)
    transfer = adapt(mesh, uniform(mesh, 0.04)).transfer
    linear = mesh.rest @ np.array([[1.0, 2.0], [3.0, -1.0], [0.0, 0.0]]) + 5.0
    flat = transfer.at_nodes(linear[:, 0])
    assert flat.shape == (transfer.nodes.shape[0],)
    wide = transfer.at_nodes(linear)
    assert np.array_equal(wide[:, 0], flat)
    vertices = transfer.at_vertices(np.stack([linear, linear], axis=2))
    assert vertices.shape == (transfer.vertices.shape[0], 2, 2)


def test_survivors_keep_their_values_exactly_and_their_order() -> None:
    mesh = random_delaunay(8)
    result = adapt(mesh, ridge(mesh, finest=0.03, coarsest=0.3))
    transfer = result.transfer
    alive = np.flatnonzero(transfer.new_node >= 0)
    assert 0 < len(alive) < len(mesh.positions)
    assert np.array_equal(transfer.new_node[alive], np.arange(len(alive)))
    assert np.array_equal(result.mesh.positions[: len(alive)], mesh.positions[alive])
    indices = np.arange(len(mesh.positions), dtype=np.int32).reshape(-1, 1)
    assert np.array_equal(transfer.node_indices(indices), transfer.new_node[:, None])


def test_labels_of_a_line_follow_it_and_do_not_spread() -> None:
    mesh = sewn_panels(6)
    u, _, v = mesh.positions.T
    seam, hem = np.abs(u - 0.5) < 1e-12, v == 0.0
    result = adapt(mesh, uniform(mesh, 0.02))
    u, _, v = result.mesh.positions.T
    assert np.array_equal(result.transfer.marked_nodes(seam), np.abs(u - 0.5) < 1e-12)
    assert np.array_equal(result.transfer.marked_nodes(hem), v == 0.0)


def test_marks_do_not_cross_from_one_line_to_another() -> None:
    """An inner edge between marked nodes of two borders gets no mark."""
    mesh = right_grid(3)
    corner = np.isin(np.arange(16), [0, 1, 4])
    result = adapt(mesh, uniform(mesh, 0.05))
    marked = result.mesh.rest[result.transfer.marked_nodes(corner)[result.mesh.node]]
    assert ((marked[:, 0] == 0.0) | (marked[:, 1] == 0.0)).all()


def momenta(motion: Motion, nodes: Float) -> tuple[Float, Float]:
    momentum = motion.mass[nodes, None] * motion.velocities[nodes]
    return momentum.sum(axis=0), np.cross(motion.positions[nodes], momentum).sum(axis=0)


def carried(
    mesh: ClothMesh, result: AdaptResult, velocities: Float, component: Float
) -> tuple[Motion, Motion]:
    transfer = result.transfer
    before = Motion(mesh.positions, velocities, lumped_mass(mesh), component.astype(np.int32))
    new_component = np.rint(transfer.at_nodes(component)).astype(np.int32)
    after = Motion(
        result.mesh.positions, transfer.at_nodes(velocities), lumped_mass(result.mesh), new_component
    )
    return before, after


def two_sheets() -> ClothMesh:
    one, two = random_delaunay(8, seed=1), random_delaunay(8, seed=2)
    count = len(one.rest)
    return ClothMesh(
        rest=np.concatenate([one.rest, two.rest]),
        node=np.concatenate([one.node, two.node + np.int32(count)]),
        faces=np.concatenate([one.faces, two.faces + np.int32(count)]),
        frames=np.concatenate([one.frames, two.frames]),
        region=np.concatenate([one.region, two.region]),
        positions=np.concatenate([one.positions, two.positions + np.array([0.0, 0.5, 0.0])]),
        kept=np.concatenate([one.kept, two.kept]),
        pinned=np.concatenate([one.pinned, two.pinned]),
        frozen_edges=one.frozen_edges,
    )


def test_momentum_of_every_piece_is_kept() -> None:
    mesh = two_sheets()
    component = (np.arange(len(mesh.positions)) >= len(mesh.positions) // 2).astype(float)
    velocities = np.random.default_rng(1).normal(size=mesh.positions.shape)
    result = adapt(mesh, ridge(mesh, finest=0.02, coarsest=0.3))
    before, after = carried(mesh, result, velocities, component)
    fixed = after._replace(velocities=with_momentum_of(before, after))
    for piece in (0, 1):
        old = momenta(before, before.component == piece)
        unfixed = momenta(after, after.component == piece)
        new = momenta(fixed, fixed.component == piece)
        for was, drifted, now in zip(old, unfixed, new, strict=True):
            scale = float(np.linalg.norm(was))
            assert np.abs(now - was).max() < 1e-12 * max(scale, 1.0)
            assert np.abs(drifted - was).max() > 1e-6 * scale


def test_rigid_motion_stays_rigid_and_rest_stays_rest() -> None:
    mesh = random_delaunay(8)
    result = adapt(mesh, uniform(mesh, 0.04))
    one = np.zeros(len(mesh.positions))
    spin, shift = np.array([1.0, -2.0, 0.5]), np.array([0.1, 0.2, 0.3])
    before, after = carried(mesh, result, np.cross(spin, mesh.positions) + shift, one)
    # lumped mass moves, so the momentum of a rigid motion does: only the sum of masses is the same
    assert abs(after.mass.sum() / before.mass.sum() - 1.0) < 1e-12
    fixed = with_momentum_of(before, after)
    gradient = np.linalg.lstsq(np.column_stack([after.positions, np.ones(len(fixed))]), fixed, rcond=None)
    assert np.abs(np.column_stack([after.positions, np.ones(len(fixed))]) @ gradient[0] - fixed).max() < 1e-12
    before, after = carried(mesh, result, 0.0 * mesh.positions, one)
    assert not with_momentum_of(before, after).any()


def test_a_piece_on_a_line_takes_no_spin_about_it() -> None:
    line = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    before = Motion(line, np.array([[0.0, 1, 0], [0, 0, 0], [0, -1, 2]]), np.ones(3), np.zeros(3, np.int32))
    after = before._replace(velocities=np.zeros((3, 3)))
    fixed = after._replace(velocities=with_momentum_of(before, after))
    everyone = np.ones(3, bool)
    for was, now in zip(momenta(before, everyone), momenta(fixed, everyone), strict=True):
        assert np.abs(now - was).max() < 1e-12
