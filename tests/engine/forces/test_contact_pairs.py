"""Thickness and friction belong to fabrics: per node, and per pair of materials."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.step.test_only_what_is_asked import SLACK, options, sheet
from toile.collide.avatar_surface import AvatarSurface
from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.contact_pairs import BODY, node_thickness, pair_friction
from toile.engine.step.cloth_forces import cloth_stepper
from toile.geometry.stage_clock import StageClock

THIN = replace(SLACK, name="thin", thickness=1e-4, friction_body=0.2, friction_self=0.1)
THICK = replace(SLACK, name="thick", thickness=4e-3, friction_body=0.6, friction_self=0.4)


def two_sheets(gap: float) -> Cloth:
    """A thin sheet and, `gap` [m] above it, a thick one; both in the x, y plane."""
    one = sheet(THIN)
    count = len(one.positions)
    above = one.positions + np.array([0.0, 0.0, gap])
    return replace(
        one, positions=np.concatenate([one.positions, above]),
        velocities=np.zeros((2 * count, 3)), node=np.arange(2 * count, dtype=np.int32),
        faces=np.concatenate([one.faces, one.faces + np.int32(count)]),
        rest_corners=np.concatenate([one.rest_corners] * 2), fabrics=(THIN, THICK),
        fabric=np.repeat(np.array([0, 1], np.int32), len(one.faces)),
        garment=np.repeat(np.array([0, 1], np.int32), len(one.faces)), panel=np.tile(one.panel, 2),
        uv=np.tile(one.uv, (2, 1)), pinned=np.zeros(2 * count, bool),
        rest_curved=np.zeros(2 * len(one.faces), bool),
        start_positions=np.concatenate([one.positions, above]),
    )  # fmt: skip


def test_every_node_has_the_thickness_of_its_fabric() -> None:
    cloth = two_sheets(0.01)
    count = len(cloth.positions) // 2
    assert np.array_equal(node_thickness(cloth), np.repeat([1e-4, 4e-3], count))


def test_friction_is_of_the_pair() -> None:
    cloth = two_sheets(0.01)
    count = len(cloth.positions) // 2
    friction = pair_friction(cloth, 2, {frozenset(("thick", BODY)): 0.9})
    body = 2 * count
    pairs = np.array(
        [(0, 1, 2, 3), (0, 0, count, 0), (count, 0, count + 1, 0), (0, 0, body, 0), (body, 0, count, 0)],
        np.int32,
    )
    assert friction.of(pairs) == pytest.approx([0.1, 0.2, 0.4, 0.2, 0.9])
    named = pair_friction(cloth, 0, {frozenset(("thick", "thin")): 0.75, frozenset(("thin",)): 0.5})
    assert named.of(pairs[:3]) == pytest.approx([0.5, 0.75, 0.4])


@pytest.mark.parametrize(("gap", "touches"), [(0.0024, True), (0.0026, False)])
def test_two_layers_keep_half_of_both_their_radii(gap: float, touches: bool) -> None:
    """Thin cloth has the least radius of 1 mm, thick cloth its own 4 mm: together 2.5 mm."""
    stepper = cloth_stepper(two_sheets(gap), None, options(self_contact=True), StageClock())
    assert stepper.collisions is not None
    assert bool(stepper.collisions.detect(stepper.x).count) is touches


def test_thick_cloth_lies_farther_from_the_body_than_thin_cloth() -> None:
    plate = np.array([(-2.0, -2.0, -0.003), (2.0, -2.0, -0.003), (2.0, 2.0, -0.003), (-2.0, 2.0, -0.003)])
    faces = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    for fabric, touches in ((THIN, False), (THICK, True)):
        cloth = replace(sheet(fabric), fabrics=(fabric,))
        stepper = cloth_stepper(cloth, AvatarSurface(plate, faces), options(), StageClock())
        assert stepper.collisions is not None
        assert bool(stepper.collisions.detect(stepper.x).count) is touches
