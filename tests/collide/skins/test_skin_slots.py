"""Skins that meet are held apart; a limb's own other side is not."""

import numpy as np
import pytest
import trimesh

from toile.collide.audit import crossings_within
from toile.collide.skins.skin_slots import SLOT, SkinSlots
from toile.geometry.arrays import Float, Int


def two_balls(distance: float) -> tuple[Float, Int]:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.1)
    other = ball.copy()
    ball.apply_translation([-0.5 * distance, 0.0, 0.0])
    other.apply_translation([0.5 * distance, 0.0, 0.0])
    both = trimesh.util.concatenate([ball, other])
    return np.ascontiguousarray(both.vertices, np.float64), np.ascontiguousarray(both.faces, np.int32)


@pytest.mark.parametrize("distance", [0.185, 0.2, 0.21])
def test_balls_that_cross_or_nearly_touch_get_a_slot_between_them(distance: float) -> None:
    vertices, faces = two_balls(distance)
    everywhere = np.ones(len(vertices), bool)
    apart = SkinSlots(vertices, faces).held_apart(vertices, everywhere)
    half = len(vertices) // 2
    gap = apart[half:, 0].min() - apart[:half, 0].max()
    assert 0.75 * SLOT < gap < 1.1 * SLOT
    assert not len(crossings_within(apart, faces, np.arange(len(vertices), dtype=np.int32)))


def test_skins_far_apart_and_skin_far_from_cloth_stay() -> None:
    vertices, faces = two_balls(0.24)
    assert not SkinSlots(vertices, faces).retreat(vertices, np.ones(len(vertices), bool)).any()
    vertices, faces = two_balls(0.19)
    assert not SkinSlots(vertices, faces).retreat(vertices, np.zeros(len(vertices), bool)).any()


def test_a_thin_limb_is_not_taken_for_two_skins() -> None:
    limb = trimesh.creation.capsule(height=0.3, radius=0.015, count=[24, 24]).subdivide()
    vertices = np.ascontiguousarray(limb.vertices, np.float64)
    faces = np.ascontiguousarray(limb.faces, np.int32)
    assert not SkinSlots(vertices, faces).retreat(vertices, np.ones(len(vertices), bool)).any()
