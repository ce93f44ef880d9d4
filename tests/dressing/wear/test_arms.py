from dataclasses import replace

import numpy as np
import pytest

from tests.dressing.wear.test_start_repair import panels
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.arms import STUMP, drawn_in_arms
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError


@pytest.fixture(scope="module")
def body() -> Avatar:
    return mannequin()


def placed(half: float, height: float, name: str) -> GarmentMesh:
    """A square panel in front of the body, centred at this height [m]."""
    across = np.linspace(-half, half, 41)
    x, y = (side.ravel() for side in np.meshgrid(across, height + across))
    return replace(
        panels(half, 0.3), positions=np.column_stack((x, y, np.full(len(x), 0.3))),
        uv=np.column_stack((x, y)), panel_names=(name,),
    )  # fmt: skip


def sleeve(half: float, at: Float) -> GarmentMesh:
    """A square sleeve panel around a place [m]."""
    flat = panels(half, 0.3)
    return replace(flat, positions=flat.positions + at, panel_names=("arm piece",), panel_roles=("sleeve",))


def test_wide_garment_draws_the_arms_in(body: Avatar) -> None:
    drawn = drawn_in_arms(body.vertices, measure(body), [placed(0.6, 0.9, "skirt_front")])
    assert drawn is not None
    moved = np.linalg.norm(drawn - body.vertices, axis=1) > 1e-9
    found = measure(body)
    shoulder = np.array(found.shoulder_point)
    # Nothing but arms moves: neither the trunk nor anything above the shoulders or below the hands.
    assert (np.abs(body.vertices[moved, 0]) > shoulder[0] - 0.02).all()
    assert np.array_equal(drawn[~moved], body.vertices[~moved])
    # What is left of an arm ends a little beyond the stump, on both sides.
    reach = np.linalg.norm(drawn[moved] - shoulder * np.sign(drawn[moved, :1]) ** [1, 0, 0], axis=1)
    assert 0.0 < reach.max() < STUMP + 0.15
    assert (drawn[moved, 0] > 0).any() and (drawn[moved, 0] < 0).any()
    assert np.abs(drawn[:, 0]).max() < 0.75 * np.abs(body.vertices[:, 0]).max()


def test_arms_stay_for_narrow_panels_long_sleeves_and_curved_garments(body: Avatar) -> None:
    wide = placed(0.6, 0.9, "skirt_front")
    found = measure(body)
    assert drawn_in_arms(body.vertices, found, [wide, sleeve(1.2, np.array([0.0, 1.2, 0.0]))]) is None
    assert drawn_in_arms(body.vertices, found, [placed(0.1, 1.0, "front")]) is None
    assert drawn_in_arms(body.vertices, found, [replace(wide, flat=False)]) is None


def test_short_sleeves_keep_the_part_of_the_arm_they_cover(body: Avatar) -> None:
    found = measure(body)
    shoulder = np.array(found.shoulder_point)
    axis = np.array([np.cos(found.arm_angle), -np.sin(found.arm_angle), 0.0])
    wide, short = placed(0.6, 0.9, "skirt_front"), sleeve(0.02, shoulder + 0.25 * axis)
    bare = drawn_in_arms(body.vertices, found, [wide])
    sleeved = drawn_in_arms(body.vertices, found, [wide, short])
    assert bare is not None and sleeved is not None
    near = ((body.vertices - shoulder) @ axis < 0.24) & (body.vertices[:, 0] > 0.0)
    assert np.array_equal(sleeved[near], body.vertices[near])
    assert not np.array_equal(bare[near], body.vertices[near])
    # The other arm has no sleeve.
    right = body.vertices[:, 0] < 0.0
    assert np.array_equal(sleeved[right], bare[right])


def test_body_that_cannot_be_measured_keeps_its_arms(body: Avatar) -> None:
    lying = replace(body, vertices=np.ascontiguousarray(body.vertices[:, [0, 2, 1]] * [1.0, 1.0, -1.0]))
    form = DressForm(lying)
    assert isinstance(form.measured, InputError)
    with pytest.raises(InputError, match="cannot be measured"):
        _ = form.measurements
    assert drawn_in_arms(lying.vertices, None, [placed(0.6, 0.9, "skirt_front")]) is None
