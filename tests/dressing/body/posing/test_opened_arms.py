"""Arms that hang are opened to the sides, and back to where they were; other skin stays."""

from dataclasses import replace

import numpy as np
import pytest

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.avatar_crossings import crossing_pairs
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.mannequin_figure import ARM_ANGLE, SHOULDER
from toile.dressing.body.posing.limb import arms_of
from toile.dressing.body.posing.opened_arms import DOWN, opened_arms
from toile.geometry.arrays import Float

SHARES = np.array([1.0, 0.5, 0.0])


@pytest.fixture(scope="module")
def body() -> Avatar:
    return mannequin()


def with_arms(body: Avatar, down: float, elbow: float = 0.0) -> Avatar:
    """The mannequin with its arms `down` radians lower, forearms bent to the front."""
    v, height = body.vertices, float(body.vertices[:, 1].max())
    side = np.sign(v[:, 0])
    still = np.zeros(len(v))
    shoulder = height * np.column_stack((side * SHOULDER[0], still + SHOULDER[1], still))
    axis = np.column_stack((side * np.cos(ARM_ANGLE), still - np.sin(ARM_ANGLE), still))
    along = np.einsum("ij,ij->i", v - shoulder, axis)
    across = np.linalg.norm(v - shoulder - along[:, None] * axis, axis=1)
    share = np.clip((along / height + 0.03) / 0.08, 0.0, 1.0) * (across < 0.07 * height)
    bent = np.clip((along / height - 0.14) / 0.06, 0.0, 1.0) * (share == 1.0) * elbow
    elbows = shoulder + 0.17 * height * axis
    arm = v - elbows
    turned = elbows + np.column_stack(
        (arm[:, 0], np.cos(bent) * arm[:, 1] + np.sin(bent) * arm[:, 2],
         np.cos(bent) * arm[:, 2] - np.sin(bent) * arm[:, 1])
    )  # fmt: skip
    away, angle = turned - shoulder, side * share * down
    moved = away.copy()
    moved[:, 0] = np.cos(angle) * away[:, 0] + np.sin(angle) * away[:, 1]
    moved[:, 1] = np.cos(angle) * away[:, 1] - np.sin(angle) * away[:, 0]
    return replace(body, vertices=shoulder + moved)


def angles(body: Avatar, vertices: Float) -> float:
    return float(DressForm(replace(body, vertices=vertices)).measurements.arm_angle)


@pytest.mark.parametrize("elbow", [0.0, 1.2], ids=["straight", "bent"])
def test_arms_open_and_return(body: Avatar, elbow: float) -> None:
    posed = with_arms(body, 0.5, elbow)
    frames = opened_arms(posed.vertices, posed.faces, SHARES)
    assert frames is not None
    assert np.array_equal(frames[2], posed.vertices)
    assert angles(body, frames[0]) == pytest.approx(DOWN, abs=np.radians(6.0))
    own, open_ = (DressForm(replace(body, vertices=v)).measurements for v in (body.vertices, frames[0]))
    assert open_.chest == pytest.approx(own.chest, abs=0.035)
    assert open_.upper_arm == pytest.approx(own.upper_arm, abs=0.02)
    assert open_.arm_length == pytest.approx(own.arm_length, abs=0.05)
    # Trunk, head and legs do not move, and no crease crosses itself.
    still = (np.abs(posed.vertices[:, 0]) < 0.06) | (posed.vertices[:, 1] < 0.6)
    assert np.array_equal(frames[0][still], posed.vertices[still])
    assert not len(crossing_pairs(frames[0], posed.faces))
    # Half the way lies between.
    hand = int(posed.vertices[:, 0].argmax())
    way = np.linalg.norm(np.diff(frames[:, hand], axis=0), axis=1)
    assert way.min() > 0.3 * way.sum()


def test_arms_end_at_the_armpit(body: Avatar) -> None:
    arms = arms_of(body.vertices, body.faces)
    assert arms is not None and {float(np.sign(arm.centres[-1, 0])) for arm in arms} == {-1.0, 1.0}
    armpit = DressForm(body).measurements.armpit_height
    for arm in arms:
        assert arm.centres[0, 1] == pytest.approx(armpit, abs=0.08)
        assert (np.diff(arm.levels) < 0.0).all() and len(arm.levels) == len(arm.centres)


def test_a_body_without_arms_has_none(body: Avatar) -> None:
    vertices = body.vertices.copy()
    vertices[:, 0] = np.clip(vertices[:, 0], -0.18, 0.18)
    frames = opened_arms(vertices, body.faces, SHARES)
    assert frames is None or isinstance(DressForm(replace(body, vertices=frames[0])).measured, Exception)
