"""Panels start rolled around trunk, neck and arms: they keep their shape, and partners' edges meet."""

from dataclasses import replace

import numpy as np
import pytest

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.drafts import built_in
from toile.dressing.wear.start.rings import facing_of, owner_of, rolled, rolled_rings
from toile.dressing.wear.start.sleeve_tubes import rolled_sleeves
from toile.geometry.arrays import Float


@pytest.fixture(scope="module")
def body() -> Avatar:
    return mannequin()


@pytest.fixture(scope="module")
def measured(body: Avatar) -> Measurements:
    return measure(body)


@pytest.fixture(scope="module")
def shirt(measured: Measurements) -> GarmentMesh:
    return mesh_pattern(built_in("tshirt", measured), edge_length=0.03)


@pytest.fixture(scope="module")
def worn(shirt: GarmentMesh, body: Avatar, measured: Measurements) -> GarmentMesh:
    obstacle = (body.vertices, body.faces)
    ringed, _ = rolled_rings(shirt, obstacle, measured.shoulder_point[1])
    return rolled_sleeves(ringed, obstacle, measured, measured.arm_angle)[0]


def lengths(mesh: GarmentMesh, places: Float) -> Float:
    """Lengths of all sides of all faces [m], shape (t, 3)."""
    corners = places[mesh.faces]
    return np.asarray(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2))


@pytest.mark.parametrize("angle", [90.0, -40.0])
def test_a_roll_keeps_lengths_along_the_panel(angle: float) -> None:
    axis = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    for end in ([0.3, 0.1], [0.0, 0.4], [-0.25, 0.2]):
        line = np.linspace([0.05, 1.0], np.add([0.05, 1.0], end), 4001)
        for facing in (1.0, -1.0):
            flat = np.column_stack([line, np.full(len(line), 0.3)])
            bent = rolled(flat, np.full(len(line), facing), 0.17, axis, 0.02, (0.03, 0.05))
            length = np.linalg.norm(np.diff(bent, axis=0), axis=1).sum()
            assert length == pytest.approx(np.linalg.norm(end), rel=1e-6)
            centre = bent - [0.03 * -axis[1], 0.03 * axis[0], 0.05]
            off_axis = centre - np.outer(centre[:, :2] @ axis, np.append(axis, 0.0))
            assert np.linalg.norm(off_axis, axis=1) == pytest.approx(0.17)


def test_a_shirt_starts_around_the_body_in_its_own_shape(shirt: GarmentMesh, worn: GarmentMesh) -> None:
    owner, moved = owner_of(shirt), np.any(worn.positions != shirt.positions, axis=1)
    assert set(np.unique(owner[moved])) == set(range(len(shirt.panel_names)))
    flat, bent = lengths(shirt, shirt.positions), lengths(worn, worn.positions)
    # A side is the chord of an arc: shorter by l^2/24 R^2, and never longer.
    assert (bent <= flat + 1e-12).all()
    assert (1.0 - bent / flat).max() < 0.04**2 / (24.0 * 0.05**2)
    assert np.sign(facing_of(worn)) == pytest.approx(np.sign(facing_of(shirt)))


def test_edges_that_are_sewn_start_near_each_other(shirt: GarmentMesh, worn: GarmentMesh) -> None:
    def gaps(mesh: GarmentMesh) -> Float:
        ends = mesh.positions[mesh.stitches]
        return np.asarray(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1))

    assert np.median(gaps(worn)) < 0.4 * np.median(gaps(shirt))
    assert gaps(worn).max() < gaps(shirt).max()


def test_what_is_no_ring_stays_flat(shirt: GarmentMesh, body: Avatar, measured: Measurements) -> None:
    obstacle = (body.vertices, body.faces)
    level = measured.shoulder_point[1]
    wide = replace(shirt, positions=shirt.positions * [4.0, 1.0, 1.0])
    assert rolled_rings(wide, obstacle, level)[0] is wide, "sleeves cut on: wider than any bodice"
    curved = replace(shirt, flat=False)
    assert rolled_rings(curved, obstacle, level)[0] is curved
    assert rolled_sleeves(curved, obstacle, measured, measured.arm_angle)[0] is curved
    assert rolled_rings(shirt, obstacle, -np.inf)[0] is shirt, "a body that cannot be measured"
    assert rolled_sleeves(shirt, obstacle, None, 0.0)[0] is shirt
