"""Built-in patterns: they can be sewn, fit the body they were drafted to, and start clear of it."""

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fcl
import manifold3d
import numpy as np
import pytest

from toile.dressing.body.avatar import Avatar, load_avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.drafts import built_in, built_in_names
from toile.dressing.pattern.drafts.drafting import Side
from toile.dressing.pattern.garmentcode import check_pattern, read_garmentcode
from toile.dressing.pattern.garmentcode_write import write_garmentcode
from toile.dressing.pattern.pattern import Panel, Pattern
from toile.dressing.pattern.pattern_curve import edge_length, edge_points, polyline_curve
from toile.dressing.pattern.pattern_outline import (
    default_segments,
    is_clockwise,
    outline,
    rotation_matrix,
    signed_area,
    to_world,
)
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

NAMES = ("circle_skirt", "trousers", "tshirt")
REAL_BODIES = ("mean_all.obj", "mean_female.ply", "mean_male.ply", "mh_child_8.ply", "mh_f_heavy_short.ply")

BODY = Measurements(
    height=1.70,
    neck=0.37,
    chest=0.92,
    waist=0.74,
    hip=0.98,
    upper_arm=0.30,
    wrist=0.17,
    thigh=0.55,
    shoulder_width=0.38,
    neck_width=0.14,
    arm_length=0.55,
    inseam=0.78,
    neck_height=1.44,
    shoulder_height=1.40,
    armpit_height=1.26,
    chest_height=1.24,
    waist_height=1.06,
    hip_height=0.87,
    crotch_height=0.78,
    arm_angle=math.pi / 4.0,
    shoulder_point=(0.19, 1.40, -0.02),
    torso_depth=(-0.13, 0.13),
)
HEAVY = dataclasses.replace(
    BODY, chest=1.3, waist=1.25, hip=1.2, upper_arm=0.45, thigh=0.75, torso_depth=(-0.2, 0.3)
)
PEAR = dataclasses.replace(BODY, waist=0.66, hip=1.2, thigh=0.74)
T_POSE = dataclasses.replace(BODY, arm_angle=0.0)
ARMS_DOWN = dataclasses.replace(BODY, arm_angle=math.radians(85.0))


def scaled(body: Measurements, factor: float) -> Measurements:
    """All lengths times a factor, angles kept."""
    values: dict[str, Any] = {}
    for field in dataclasses.fields(body):
        value = getattr(body, field.name)
        if isinstance(value, tuple):
            values[field.name] = tuple(component * factor for component in value)
        else:
            values[field.name] = value if field.name == "arm_angle" else value * factor
    return Measurements(**values)


BODIES = {
    "average": BODY,
    "child": scaled(BODY, 1.1 / 1.7),
    "tall": scaled(BODY, 2.0 / 1.7),
    "heavy": HEAVY,
    "pear": PEAR,
    "T-pose": T_POSE,
    "arms down": ARMS_DOWN,
}


@pytest.fixture(params=BODIES)
def body(request: pytest.FixtureRequest) -> Measurements:
    """Measurements of very different bodies."""
    return BODIES[request.param]


@pytest.fixture(params=NAMES)
def pattern(request: pytest.FixtureRequest, body: Measurements) -> Pattern:
    """Every pattern on every body."""
    return built_in(request.param, body)


def stitch_lengths(pattern: Pattern) -> Iterator[tuple[str, float, float]]:
    for stitch in pattern.stitches:
        a = edge_length(pattern.panel(stitch.panel_a), stitch.edge_a)
        b = edge_length(pattern.panel(stitch.panel_b), stitch.edge_b)
        yield stitch.name, a, b


def width_at(panel: Panel, y: float) -> float:
    """Width [m] of the fabric along a level of the panel's own plane."""
    polygon, _ = outline(panel, default_segments(panel, 200))
    ahead = np.roll(polygon, -1, axis=0)
    crossing = (polygon[:, 1] - y) * (ahead[:, 1] - y) < 0.0
    a, b = polygon[crossing], ahead[crossing]
    x = np.sort(a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
    return float(np.sum(x[1::2] - x[::2]))


def labelled_length(pattern: Pattern, label: str) -> float:
    return sum(
        edge_length(panel, index)
        for panel in pattern.panels
        for index, edge in enumerate(panel.edges)
        if edge.label.endswith(label)
    )


def collision_object(vertices: Float, faces: Int) -> fcl.CollisionObject:
    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(faces))
    model.addSubModel(np.ascontiguousarray(vertices), np.ascontiguousarray(faces))
    model.endModel()
    return fcl.CollisionObject(model, fcl.Transform())


def distance(a: fcl.CollisionObject, b: fcl.CollisionObject) -> float:
    """Distance [m]; 0 if the surfaces cross."""
    if fcl.collide(a, b, fcl.CollisionRequest(), fcl.CollisionResult()):
        return 0.0
    return float(fcl.distance(a, b, fcl.DistanceRequest(), fcl.DistanceResult()))


def assert_clear(avatar: Avatar | None, pattern: Pattern) -> None:
    garment = mesh_pattern(pattern, edge_length=0.04)
    panels = [
        collision_object(garment.positions, garment.faces[garment.panel == i])
        for i in range(len(pattern.panels))
    ]
    for i, name in enumerate(garment.panel_names):
        for j in range(i):
            assert distance(panels[i], panels[j]) >= 0.01, (name, garment.panel_names[j])
    if avatar is not None:
        solid = collision_object(avatar.vertices, avatar.faces)
        for panel, name in zip(panels, garment.panel_names, strict=True):
            assert distance(panel, solid) >= 0.01, name


def test_names() -> None:
    assert built_in_names() == NAMES
    assert built_in("T-Shirt", BODY) == built_in("tshirt", BODY)


def test_unknown_name_suggests_the_nearest() -> None:
    with pytest.raises(InputError, match="trousers"):
        built_in("trouser", BODY)


@pytest.mark.parametrize("name", NAMES)
def test_impossible_measurements_are_named(name: str) -> None:
    with pytest.raises(InputError, match="neck is nan"):
        built_in(name, dataclasses.replace(BODY, neck=math.nan))
    with pytest.raises(InputError, match=r"hip_height .* is not below"):
        built_in(name, dataclasses.replace(BODY, hip_height=1.45))


def test_outlines_are_simple_and_stitches_can_be_sewn(pattern: Pattern) -> None:
    check_pattern(pattern)
    for panel in pattern.panels:
        polygon, _ = outline(panel, default_segments(panel))
        # where an outline crosses itself, loops of opposite sense count against each other in the signed area
        inside = manifold3d.CrossSection([polygon], manifold3d.FillRule.EvenOdd).area()
        assert abs(signed_area(polygon)) == pytest.approx(inside, rel=1e-6), panel.name


def test_stitched_edges_are_equally_long(pattern: Pattern) -> None:
    """Within 1 %, which is also the intended ease of the sleeve cap."""
    for name, a, b in stitch_lengths(pattern):
        assert abs(a / b - 1.0) < 0.0101, name


def test_cap_is_one_percent_longer_than_the_armhole(body: Measurements) -> None:
    shirt = built_in("tshirt", body)
    caps = [
        edge_length(shirt.panel(s.panel_a), s.edge_a) / edge_length(shirt.panel(s.panel_b), s.edge_b)
        for s in shirt.stitches
        if "sleeve" in s.panel_a and "sleeve" not in s.panel_b
    ]
    np.testing.assert_allclose(caps, [1.01] * 4, atol=1e-6)


def test_fabric_faces_away_from_the_body(pattern: Pattern) -> None:
    for panel in pattern.panels:
        normal = rotation_matrix(panel.rotation_degrees)[:, 2] * (-1.0 if is_clockwise(panel) else 1.0)
        assert normal[2] * panel.translation[2] > 0.0, panel.name


def test_stitches_run_in_the_right_direction(pattern: Pattern) -> None:
    """Sewn end to start, edges have no longer way to each other than sewn start to start."""
    for stitch in pattern.stitches:
        a, b = pattern.panel(stitch.panel_a), pattern.panel(stitch.panel_b)
        points_a = to_world(a, edge_points(a, stitch.edge_a, 8))
        points_b = to_world(b, edge_points(b, stitch.edge_b, 8))
        if a.name == b.name.replace("right", "left") != b.name:
            # A middle seam joins mirror images; the crotch curves are too level for distances to tell.
            np.testing.assert_allclose(points_a[:, :2] * (-1.0, 1.0), points_b[::-1, :2], atol=1e-9)
            continue
        sewn, swapped = np.linalg.norm(points_a - points_b[::-1]), np.linalg.norm(points_a - points_b)
        assert sewn < swapped + 1e-9, stitch.name


def test_no_edge_is_sewn_twice(pattern: Pattern) -> None:
    edges = [(s.panel_a, s.edge_a) for s in pattern.stitches] + [
        (s.panel_b, s.edge_b) for s in pattern.stitches
    ]
    assert len(edges) == len(set(edges))


def test_left_and_right_are_mirror_images(pattern: Pattern) -> None:
    corners = np.concatenate([to_world(panel, np.array(panel.vertices)) for panel in pattern.panels])
    # The skirt's left and right quarters hang in different planes.
    flat = corners[:, :2] if pattern.name == "circle_skirt" else corners
    mirrored = flat * ([-1.0, 1.0] if pattern.name == "circle_skirt" else [-1.0, 1.0, 1.0])
    nearest = np.linalg.norm(flat[:, None] - mirrored[None], axis=2).min(axis=1)
    assert nearest.max() < 1e-9


def test_panels_are_clear_of_each_other(pattern: Pattern) -> None:
    assert_clear(None, pattern)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("factor", [1.1 / 1.7, 2.0 / 1.7])
def test_a_larger_body_gets_the_same_pattern_larger(name: str, factor: float) -> None:
    small, large = built_in(name, BODY), built_in(name, scaled(BODY, factor))
    assert small.stitches == large.stitches
    for a, b in zip(small.panels, large.panels, strict=True):
        np.testing.assert_allclose(np.array(a.vertices) * factor, b.vertices, atol=1e-9)
        np.testing.assert_allclose(np.array(a.translation) * factor, b.translation, atol=1e-9)


def test_tshirt_girths(body: Measurements) -> None:
    shirt = built_in("tshirt", body)
    scale = body.height / 1.70
    front, back = shirt.panel("front"), shirt.panel("back")
    # The side seam ends at the underarm: the highest corner on the outer edge of the front.
    right_half = [vertex for vertex in front.vertices if vertex[0] > 0.0]
    underarm = sorted(y for _, y in right_half)[1]
    chest = width_at(front, underarm - 1e-4) + width_at(back, underarm - 1e-4)
    assert chest >= body.chest + 0.08 * scale - 2e-3
    assert chest <= max(body.chest + 0.08 * scale, body.hip + 0.05 * scale) + 2e-3
    hem = width_at(front, body.hip_height + 1e-4) + width_at(back, body.hip_height + 1e-4)
    assert hem >= body.hip + 0.05 * scale - 2e-3
    sleeves = [panel for panel in shirt.panels if "left_sleeve" in panel.name]
    sleeve = sum(np.ptp(np.array(panel.vertices)[:, 1]) for panel in sleeves)
    assert sleeve >= body.upper_arm + 0.07 * scale - 1e-6
    assert labelled_length(shirt, "collar") >= 1.15 * body.neck - 1e-9
    assert labelled_length(shirt, "collar") <= 2.0 * body.neck


@pytest.mark.parametrize("name", ["circle_skirt", "trousers"])
def test_waistband_holds_at_the_waist(name: str, body: Measurements) -> None:
    garment = built_in(name, body)
    band = labelled_length(garment, "lower_interface")
    assert band == pytest.approx(body.waist + 0.015 * body.height / 1.70, abs=1e-9)
    if body is HEAVY:
        assert "friction" in garment.notes[0]
    else:
        assert band < body.hip and garment.notes == ()


def test_skirt_is_a_full_circle_to_the_knee(body: Measurements) -> None:
    skirt = built_in("circle_skirt", body)
    band = labelled_length(skirt, "lower_interface")
    quarters = [panel for panel in skirt.panels if "waistband" not in panel.name]
    hem = sum(
        edge_length(panel, i) for panel in quarters for i, e in enumerate(panel.edges) if _is_hem(panel, i)
    )
    length = body.waist_height - 0.0175 * body.height / 1.70 - 0.6 * body.crotch_height
    assert hem == pytest.approx(band + 2.0 * math.pi * length, rel=1e-6)


def _is_hem(panel: Panel, index: int) -> bool:
    lowest = sorted(range(len(panel.vertices)), key=lambda i: panel.vertices[i][1])[:2]
    return {panel.edges[index].start, panel.edges[index].end} == set(lowest)


def test_trouser_girths(body: Measurements) -> None:
    trousers = built_in("trousers", body)
    scale = body.height / 1.70
    legs = [panel for panel in trousers.panels if "waistband" not in panel.name]
    hip = max(body.hip_height, body.crotch_height + 0.03 * scale)
    assert sum(width_at(panel, hip + 1e-4) for panel in legs) == pytest.approx(
        body.hip + 0.06 * scale, abs=0.01
    )
    left = [panel for panel in legs if panel.name.startswith("left")]
    crotch = body.crotch_height - 0.02 * scale
    # Measured at the front's crotch point, above the slightly lower one of the back.
    assert sum(width_at(panel, crotch + 1e-4) for panel in left) >= body.thigh
    hem = 0.055 * body.height
    assert sum(width_at(panel, hem + 1e-4) for panel in left) == pytest.approx(0.7 * body.thigh, abs=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_round_trip_through_a_file(name: str, tmp_path: Path) -> None:
    pattern = built_in(name, BODY)
    path = tmp_path / f"{name}_specification.json"
    write_garmentcode(pattern, path)
    again = read_garmentcode(path)
    assert again.name == name and again.stitches == pattern.stitches
    for a, b in zip(pattern.panels, again.panels, strict=True):
        assert [(e.start, e.end, e.label, type(e.curve)) for e in a.edges] == [
            (e.start, e.end, e.label, type(e.curve)) for e in b.edges
        ]
        assert (a.name, a.label) == (b.name, b.label)
        np.testing.assert_allclose(a.vertices, b.vertices, atol=1e-14)
        np.testing.assert_allclose(a.translation, b.translation, atol=1e-14)
        for i in range(len(a.edges)):
            np.testing.assert_allclose(edge_points(a, i, 7), edge_points(b, i, 7), atol=1e-12)


@pytest.mark.parametrize("height", [1.1, 1.7, 2.0])
def test_panels_start_clear_of_the_mannequin(height: float) -> None:
    k = height / 1.70
    figure = mannequin(height=height, chest=0.92 * k, waist=0.74 * k, hip=0.98 * k)
    measurements = measure(figure)
    for name in NAMES:
        assert_clear(figure, built_in(name, measurements))


@pytest.mark.parametrize("file", REAL_BODIES)
def test_panels_start_clear_of_real_bodies(file: str, data_dir: Path) -> None:
    form = DressForm(load_avatar(data_dir / "bodies" / file))
    for name in NAMES:
        assert_clear(form.avatar, built_in(name, form.measurements))


def test_a_curve_from_a_point_to_itself_is_refused() -> None:
    """A neckline of no width, as absurd measurements ask for."""
    with pytest.raises(InputError, match="edge 'neckline' has no length; check the measurements"):
        Side(name="neckline", start=(0.0, 1.4), end=(0.0, 1.4), controls=((0.1, 1.4), (0.1, 1.3))).edge(0, 2)
    points = np.array([(0.1, 0.2), (0.3, 0.2), (0.1, 0.2)])
    with pytest.raises(InputError, match=r"begins and ends in one point, \(0.1, 0.2\) m"):
        polyline_curve(points)
