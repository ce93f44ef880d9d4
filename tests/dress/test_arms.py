from dataclasses import replace

import numpy as np
import pytest

from tests.dress.test_start_repair import panels
from toile.dress.arms import STUMP, drawn_in_arms
from toile.dress.avatar import Avatar
from toile.dress.garment_mesh import GarmentMesh
from toile.dress.mannequin import mannequin
from toile.dress.measure import measure


@pytest.fixture(scope="module")
def body() -> Avatar:
    return mannequin()


def placed(half: float, height: float, name: str) -> GarmentMesh:
    """A square panel in front of the body, centred at this height [m]."""
    across = np.linspace(-half, half, 41)
    x, y = (side.ravel() for side in np.meshgrid(across, height + across))
    return replace(
        panels(half, 0.3), positions=np.column_stack((x, y, np.full(len(x), 0.3))), panel_names=(name,)
    )


def test_wide_garment_without_sleeves_draws_the_arms_in(body: Avatar) -> None:
    drawn = drawn_in_arms(body.vertices, body, [placed(0.6, 0.9, "skirt_front")])
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


def test_arms_stay_for_sleeves_narrow_panels_and_curved_garments(body: Avatar) -> None:
    wide = placed(0.6, 0.9, "skirt_front")
    assert drawn_in_arms(body.vertices, body, [wide, placed(0.1, 1.2, "left_sleeve")]) is None
    assert drawn_in_arms(body.vertices, body, [placed(0.1, 1.0, "front")]) is None
    assert drawn_in_arms(body.vertices, body, [replace(wide, flat=False)]) is None


def test_body_that_cannot_be_measured_keeps_its_arms(body: Avatar) -> None:
    lying = replace(body, vertices=np.ascontiguousarray(body.vertices[:, [0, 2, 1]] * [1.0, 1.0, -1.0]))
    assert drawn_in_arms(lying.vertices, lying, [placed(0.6, 0.9, "skirt_front")]) is None
