"""Steps see the part of a moving avatar that cloth can come to, and never too little of it."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from tests.engine.film.test_moving_avatar import body, film, plan
from toile.engine.film.avatar_skin import ROAM, AvatarSkin
from toile.geometry.arrays import Float, Int


@pytest.mark.parametrize("seed", range(4))
def test_faces_left_out_are_farther_from_cloth_than_it_may_go(seed: int) -> None:
    generator = np.random.default_rng(seed)
    vertices, faces = body(trimesh.creation.capsule(height=1.5, radius=0.15, count=(24, 24)))
    turn = 0.2 * generator.normal(size=3)
    end = vertices + np.cross(turn, vertices) + 0.05 * generator.normal(size=3)
    cloth, cloth_faces = body(trimesh.creation.icosphere(subdivisions=2, radius=0.1))
    cloth += np.array([0.25, 0.1, 0.4])
    drift = np.tile(0.05 * generator.normal(size=3), (len(cloth), 1))

    def way(share: float, part: Int) -> Float:
        return np.asarray(vertices[part] + share**1.5 * (end - vertices)[part])

    skin = AvatarSkin(vertices, faces)
    near = skin.focus((cloth, cloth_faces), drift, end, way)
    seen = {tuple(face) for face in skin.part[near.surface.faces].tolist()}
    left_out = np.array([face for face in faces.tolist() if tuple(face) not in seen])
    assert 0 < len(seen) == len(faces) - len(left_out) < 0.8 * len(faces)
    for share in np.linspace(0.0, 1.0, 6):
        there = way(float(share), np.arange(len(vertices), dtype=np.int32))
        points = there[left_out].mean(axis=1)
        assert np.min(cKDTree(cloth + share * drift).query(points)[0]) > ROAM
    # What is seen goes where it is bound for, off its chord by what was said.
    assert near.surface.bound_for == pytest.approx(end[skin.part])
    half = way(0.5, skin.part) - vertices[skin.part] - 0.5 * (end - vertices)[skin.part]
    assert (np.linalg.norm(half, axis=1) <= near.surface.off_course + 1e-12).all()
    assert near.longest_way == pytest.approx(np.linalg.norm((end - vertices)[skin.part], axis=1).max())
    assert skin.reaches(cloth + 0.5 * drift) and not skin.reaches(cloth + drift + [0.0, 0.0, 1.1 * ROAM])


def test_cloth_that_strays_within_a_frame_meets_what_was_far() -> None:
    """A sheet thrown at a rising ball, 0.3 m away when the frame begins, at 30 m/s."""
    vertices, faces = body(trimesh.creation.icosphere(subdivisions=3, radius=0.1))
    rise = np.linspace(0.0, 0.03, 4)[:, None] * np.array([0.0, 1.0, 0.0])
    run, frames = film(vertices, faces, rise, 0.5, plan(), speed=-30.0)
    assert all(sum(found) == 0 for found in run.record.crossings)
    # The ball has stopped it, in the middle.
    last = frames[-1].cloth.positions
    assert last[np.hypot(last[:, 0], last[:, 2]).argmin(), 1] > 0.1


def test_a_body_out_of_reach_changes_nothing() -> None:
    vertices, faces = body(trimesh.creation.icosphere(subdivisions=2, radius=0.1))
    away = np.array([5.0, 0.0, 0.0])
    shake = np.array([[0.0, 0.02 * (-1) ** k, 0.0] for k in range(4)])
    one, _ = film(vertices + away, faces, shake, 0.5, plan())
    other, _ = film(vertices + 2.0 * away, faces, 0.0 * shake, 0.5, plan())
    assert one.cloth.positions == pytest.approx(other.cloth.positions, abs=1e-12)
