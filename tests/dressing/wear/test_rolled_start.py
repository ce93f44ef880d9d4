"""Panels start rolled around trunk, neck and arms: they keep their shape, and partners' edges meet."""

from dataclasses import replace

import numpy as np
import pytest

from tests.dressing.wear.test_start_repair import panels
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.drafts import built_in
from toile.dressing.wear.arms import on_sleeves
from toile.dressing.wear.start.hung_below import ROOM, hung_below
from toile.dressing.wear.start.raised_arms import STAGES, raised_arms
from toile.dressing.wear.start.rings import facing_of, owner_of, rolled, rolled_rings
from toile.dressing.wear.start.sleeve_tubes import FAR, off_opening, rolled_sleeves
from toile.dressing.wear.start.start_places import size_of, start_places
from toile.geometry.arrays import Float, Int


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


def test_a_sleeve_placed_far_out_starts_at_its_armhole(
    shirt: GarmentMesh, body: Avatar, measured: Measurements
) -> None:
    obstacle = (body.vertices, body.faces)
    ringed, _ = rolled_rings(shirt, obstacle, measured.shoulder_point[1])
    out = np.sign(ringed.positions[:, :1]) * [np.cos(measured.arm_angle), 0.0, 0.0]
    out[:, 1] = -np.sin(measured.arm_angle)
    sleeves = on_sleeves(ringed)
    far = replace(ringed, positions=ringed.positions + 0.2 * sleeves[:, None] * out)
    rolled_far, _ = rolled_sleeves(far, obstacle, measured, measured.arm_angle)
    joins = sleeves[ringed.stitches].sum(axis=1) == 1
    ends = ringed.stitches[joins]
    own = sleeves[ends]

    def away(mesh: GarmentMesh) -> float:
        """How far the edges of armholes are apart along the arms, on average."""
        between = mesh.positions[ends[own]] - mesh.positions[ends[~own]]
        return float(np.mean(np.sum(between * out[ends[own]], axis=1)))

    assert away(far) > 0.2
    assert abs(away(rolled_far)) < FAR


def test_an_arm_passes_the_opening_of_a_sleeve_that_narrows_much() -> None:
    """An opening that reaches from 5 to 20 cm above the middle of a tube of 18 cm does not hold the arm."""
    opening, radius, half = np.linspace(0.05, 0.2, 9), 0.18, 0.03
    middle = 0.5 * radius * (np.sin(0.05 / radius) + np.sin(0.2 / radius))
    assert off_opening(opening, radius, half) == pytest.approx(middle)
    assert off_opening(-opening, radius, half) == pytest.approx(-middle)
    assert off_opening(np.linspace(-0.1, 0.2, 9), radius, half) == 0.0, "it lies around the arm as it is"
    assert off_opening(np.empty(0), radius, half) == 0.0


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


def test_a_lower_tier_starts_right_below_what_it_hangs_from(measured: Measurements) -> None:
    level = measured.shoulder_point[1]
    four = panels(0.2, 0.3, -0.3, 0.3, -0.3)
    # Two panels hang from the shoulders, their lower edges 10 cm above the upper edges of the two others.
    low = np.repeat([[0.0, level - 0.2, 0.0]] * 2 + [[0.05, level - 0.7, 0.0]] * 2, 4, axis=0)
    sewn = np.array([(0, 11), (1, 10), (4, 15), (5, 14), (8, 13), (11, 14)], np.int32)
    seam = np.array([0, 0, 1, 1, 2, 2], np.int32)
    tiers = replace(
        four, positions=four.positions + low, stitches=sewn, seam=seam, seam_names=("a", "b", "c")
    )
    hung, notes = hung_below(tiers, level)
    gap = hung.positions[sewn[:4, 0]] - hung.positions[sewn[:4, 1]]
    assert gap[:, 1] == pytest.approx(ROOM), "all but a little room"
    assert np.array_equal(hung.positions[:8], tiers.positions[:8])
    assert np.array_equal(hung.positions[8:, [0, 2]], tiers.positions[8:, [0, 2]]), "only the height changes"
    assert len(notes) == 1 and "panel 2, panel 3 start 9 cm nearer" in notes[0]
    apart = replace(tiers, stitches=sewn[:4], seam=seam[:4])
    assert hung_below(apart, level)[0] is apart, "front and back do not hang together"


def test_arms_are_raised_for_sleeves_that_a_skirt_covers(
    shirt: GarmentMesh, body: Avatar, measured: Measurements
) -> None:
    assert raised_arms(body.vertices, body.faces, measured, [shirt]) is None
    sleeves = on_sleeves(shirt)
    skirt = replace(
        shirt, panel_roles=tuple("leg" if role != "sleeve" else role for role in shirt.panel_roles)
    )
    lowered = skirt.positions.copy()
    lowered[~sleeves] = (lowered[~sleeves] - [0.0, 0.25, 0.0]) * [3.0, 1.0, 1.0]
    found = raised_arms(body.vertices, body.faces, measured, [replace(skirt, positions=lowered)])
    assert found is not None
    (first, *later), (raised,) = found
    assert len(later) == STAGES - 1
    hand = int(body.vertices[:, 0].argmax())
    heights = [shape[hand, 1] for shape in (first, *later, body.vertices)]
    assert (np.diff(heights) < 0.0).all() and heights[0] > measured.shoulder_point[1] - 0.15
    # Every stage keeps the arm's length to 1 %: hands are not drawn back through cuffs.
    shoulder = np.array(measured.shoulder_point)
    reach = [float(np.linalg.norm(shape[hand] - shoulder)) for shape in (first, *later, body.vertices)]
    assert reach == pytest.approx([reach[-1]] * len(reach), rel=0.01)
    assert np.array_equal(raised.positions[~sleeves], lowered[~sleeves])
    assert lengths(raised, raised.positions) == pytest.approx(lengths(raised, lowered)), (
        "sleeves turn rigidly"
    )


def shrunken_start(
    shirt: GarmentMesh, body: Avatar, measured: Measurements, scale: float
) -> tuple[Float, Int, list[str]]:
    """Where the shirt starts on everything made smaller, its stitches, and what is said."""
    small = replace(shirt, positions=scale * shirt.positions, uv=scale * shirt.uv)
    x, y, z = measured.shoulder_point
    smaller = replace(
        measured, height=scale * measured.height, chest=scale * measured.chest,
        shoulder_point=(scale * x, scale * y, scale * z),
    )  # fmt: skip
    surface = scale * body.vertices, body.faces
    (start,), said = start_places([small], surface, surface, smaller, measured.arm_angle)
    assert np.array_equal(start.uv, small.uv)
    return start.positions, start.stitches, said


def test_a_baby_and_a_doll_start_like_a_person(
    shirt: GarmentMesh, body: Avatar, measured: Measurements
) -> None:
    """Steps of a centimetre move a shirt of a baby past its shoulders, and sleeves are not found."""
    baby, stitches, said = shrunken_start(shirt, body, measured, 0.35)
    doll, _, said_of_doll = shrunken_start(shirt, body, measured, 0.07)
    assert np.abs(baby / 0.35 - doll / 0.07).max() < 1e-9
    assert sum("start rolled around" in sentence for sentence in said) == 3
    assert len(said_of_doll) == len(said)
    centimetres = next(int(s.split(" cm from")[0].split()[-1]) for s in said if "around the body" in s)
    assert 0.03 < centimetres / 100.0 < 0.35 * 0.3, "said in centimetres of the baby"
    gap = np.linalg.norm(baby[stitches[:, 0]] - baby[stitches[:, 1]], axis=1)
    assert gap.max() < 0.35 * 0.45, "as far apart as on a person, made smaller"


def test_half_a_dress_form_is_not_small(measured: Measurements) -> None:
    assert size_of(replace(measured, height=0.6)) == 1.0
    assert size_of(replace(measured, height=1.15, chest=0.6)) == 1.0, "a child"
    assert size_of(replace(measured, height=0.6, chest=0.36)) == pytest.approx(0.4)
    assert size_of(None) == 1.0
