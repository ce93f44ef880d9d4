"""Reading and writing sewing patterns, and naming what is wrong with them."""

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toile.dressing.pattern.garmentcode import check_pattern, read_garmentcode
from toile.dressing.pattern.garmentcode_loops import reversed_loop, seam_gap
from toile.dressing.pattern.garmentcode_write import write_garmentcode
from toile.dressing.pattern.pattern import Arc, Cubic, Edge, Panel, Pattern, Quadratic, Stitch
from toile.dressing.pattern.pattern_curve import edge_length, edge_points
from toile.dressing.pattern.pattern_outline import default_segments, is_clockwise, outline, to_world
from toile.dressing.pattern.roles import EdgeRole
from toile.geometry.errors import InputError

Document = dict[str, Any]


def square(x: float, **extra: Any) -> Document:
    """Panel of 20 x 20 cm, counter-clockwise, at x cm."""
    return {
        "vertices": [[0, 0], [20, 0], [20, 20], [0, 20]],
        "edges": [{"endpoints": [i, (i + 1) % 4]} for i in range(4)],
        "translation": [x, 100, 10],
        "rotation": [0, 0, 0],
        **extra,
    }


def two_squares() -> Document:
    """Two squares side by side, sewn along the sides that face each other."""
    return {
        "pattern": {
            "panels": {"left": square(0), "right": square(30)},
            "stitches": [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 3}]],
        },
        "properties": {"units_in_meter": 100, "curvature_coords": "relative", "normalized_edge_loops": True},
    }


def read(document: Document, folder: Path) -> Pattern:
    path = folder / "tried_specification.json"
    path.write_text(json.dumps(document))
    return read_garmentcode(path)


def one_edge(
    curve: Any, start: tuple[float, float] = (0.0, 0.0), end: tuple[float, float] = (1.0, 0.0)
) -> Panel:
    return Panel(name="p", vertices=(start, end), edges=(Edge(0, 1, curve), Edge(1, 0)))


def test_units_placement_labels(tmp_path: Path) -> None:
    document = two_squares()
    panel = document["pattern"]["panels"]["left"]
    panel["label"] = "body"
    panel["edges"][2]["label"] = "left_collar"
    panel["rotation"] = [0, 90, 0]
    document["pattern"]["panel_order"] = ["right", "left"]
    pattern = read(document, tmp_path)
    assert pattern.name == "tried"
    assert [p.name for p in pattern.panels] == ["right", "left"]
    left = pattern.panel("left")
    assert left.vertices[2] == (0.2, 0.2)
    assert left.label == "body"
    assert [edge.label for edge in left.edges] == ["", "", "left_collar", ""]
    assert pattern.stitches == (Stitch("left", 1, "right", 3),)
    assert pattern.stitches[0].name == "left.1 - right.3"
    assert to_world(left, np.array([[0.2, 0.1]]))[0] == pytest.approx([0.0, 1.1, 0.1 - 0.2])
    with pytest.raises(KeyError):
        pattern.panel("middle")


def test_a_byte_order_mark_is_no_part_of_the_pattern(tmp_path: Path) -> None:
    path = tmp_path / "marked_specification.json"
    path.write_text(json.dumps(two_squares()), encoding="utf-8-sig")
    assert [panel.name for panel in read_garmentcode(path).panels] == ["left", "right"]


@pytest.mark.parametrize("number", [10**400, -(10**400), float("nan"), float("inf"), True, "1"])
def test_numbers_that_no_pattern_has_are_named(number: Any, tmp_path: Path) -> None:
    document = two_squares()
    document["pattern"]["panels"]["left"]["translation"] = [number, 100, 10]
    path = tmp_path / "odd_specification.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"panel 'left'.*must be a finite number") as caught:
        read_garmentcode(path)
    assert len(str(caught.value)) < 200


def test_edges_that_run_far_away_are_named(tmp_path: Path) -> None:
    document = two_squares()
    curve = {"type": "quadratic", "params": [[0.5, 1e6]]}
    document["pattern"]["panels"]["left"]["edges"][2]["curvature"] = curve
    path = tmp_path / "odd_specification.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match="panel 'left'") as caught:
        read_garmentcode(path)
    assert caught.value.file == path


def test_rotation_is_about_x_then_y_then_z(tmp_path: Path) -> None:
    panel = Panel(name="p", vertices=((0, 0), (1, 0), (0, 1)), edges=(), rotation_degrees=(90.0, 0.0, 90.0))
    # (0, 1) turns about x to +z, which the turn about z leaves alone; (1, 0) turns about z to +y.
    assert to_world(panel, np.array([[0.0, 1.0], [1.0, 0.0]])).tolist() == [[0, 0, 1], [0, 1, 0]]


def test_missing_units_are_centimetres_and_said(tmp_path: Path) -> None:
    document = two_squares()
    del document["properties"]["units_in_meter"]
    pattern = read(document, tmp_path)
    assert pattern.panel("left").vertices[1] == (0.2, 0.0)
    assert "centimetres" in pattern.notes[0]


def test_old_and_absolute_curvature_and_radius_units(tmp_path: Path) -> None:
    document = two_squares()
    document["properties"]["units_in_meter"] = 10
    panel = document["pattern"]["panels"]["left"]
    panel["edges"][0]["curvature"] = [0.5, -0.25]
    panel["edges"][2]["curvature"] = {"type": "circle", "params": [15, 0, 1]}
    relative = read(document, tmp_path).panel("left")
    assert relative.edges[0].curve == Quadratic((0.5, -0.25))
    assert relative.edges[2].curve == Arc(1.5, False, True)
    document["properties"]["curvature_coords"] = "absolute"
    panel["edges"][0]["curvature"] = [10, -5]
    assert read(document, tmp_path).panel("left").edges[0].curve == Quadratic((0.5, -0.25))


def test_normalised_translation_moves_the_vertex_mean_to_the_origin(tmp_path: Path) -> None:
    document = two_squares()
    before = read(document, tmp_path).panel("left")
    document["properties"]["normalize_panel_translation"] = True
    after = read(document, tmp_path).panel("left")
    assert after.vertices[0] == pytest.approx((-0.1, -0.1))
    assert to_world(after, np.array(after.vertices)) == pytest.approx(
        to_world(before, np.array(before.vertices))
    )


def test_arbitrary_loops_are_made_counter_clockwise(tmp_path: Path) -> None:
    """The right square drawn clockwise sews its seam crosswise, unless its loop is reversed."""
    document = two_squares()
    clockwise = document["pattern"]["panels"]["right"]
    clockwise["edges"] = [{"endpoints": [(i + 1) % 4, i]} for i in (3, 2, 1, 0)]
    clockwise["edges"][3]["curvature"] = {"type": "cubic", "params": [[0.2, 0.1], [0.6, 0.2]]}
    document["pattern"]["stitches"][0][1]["edge"] = 0
    as_drawn = read(document, tmp_path)
    assert is_clockwise(as_drawn.panel("right"))
    document["properties"]["normalized_edge_loops"] = False
    pattern = read(document, tmp_path)
    right = pattern.panel("right")
    assert not is_clockwise(right)
    assert pattern.stitches == (Stitch("left", 1, "right", 3),)
    assert seam_gap(pattern) < seam_gap(as_drawn)
    assert right.edges[0].curve == Cubic((0.4, -0.2), (0.8, -0.1))
    assert "reversed" in pattern.notes[-1]


def test_meaningful_loops_stay_as_drawn(tmp_path: Path) -> None:
    """A back panel is drawn clockwise on purpose: its wrong side faces +z."""
    document = two_squares()
    back = document["pattern"]["panels"]["right"]
    back["translation"] = [0, 100, -10]
    back["edges"] = [{"endpoints": [(i + 1) % 4, i]} for i in (3, 2, 1, 0)]
    document["pattern"]["stitches"][0][1]["edge"] = 2
    del document["properties"]["normalized_edge_loops"]
    assert is_clockwise(read(document, tmp_path).panel("right"))


@pytest.mark.parametrize(
    "curve", [Quadratic((0.3, 0.4)), Cubic((0.2, -0.3), (0.9, 0.5)), Arc(0.7, True, False)]
)
def test_a_reversed_loop_is_the_same_outline(curve: Any) -> None:
    panel = Panel(
        name="p", vertices=((0, 0), (1, 0.1), (0.4, 3)), edges=(Edge(0, 1, curve), Edge(1, 2), Edge(2, 0))
    )
    back = reversed_loop(panel)
    assert edge_points(back, 2, 10) == pytest.approx(edge_points(panel, 0, 10)[::-1], abs=1e-12)
    assert reversed_loop(back).edges[1:] == panel.edges[1:]


def test_straight_and_circular_lengths() -> None:
    assert edge_length(one_edge(None, end=(3.0, 4.0)), 0) == 5.0
    assert edge_length(one_edge(Arc(0.5, False, True)), 0) == pytest.approx(np.pi / 2)
    minor = 2.0 * np.arcsin(0.5)
    assert edge_length(one_edge(Arc(1.0, False, True)), 0) == pytest.approx(minor)
    assert edge_length(one_edge(Arc(1.0, True, True)), 0) == pytest.approx(2.0 * np.pi - minor)


@pytest.mark.parametrize(
    ("large", "right", "sign", "depth"),
    # Chord 1, radius 1: the middle lies 1 -/+ sqrt(3)/2 off the chord; right of travel is -y.
    [(False, True, -1, 0.1339745962), (False, False, 1, 0.1339745962), (True, True, -1, 1.8660254038),
     (True, False, 1, 1.8660254038)],
)  # fmt: skip
def test_side_on_which_an_arc_bulges(large: bool, right: bool, sign: int, depth: float) -> None:
    middle = edge_points(one_edge(Arc(1.0, large, right)), 0, 2)[1]
    assert middle == pytest.approx([0.5, sign * depth])


def test_bezier_points_against_the_formula() -> None:
    panel = one_edge(Quadratic((0.25, 0.5)), start=(1.0, 1.0), end=(1.0, 3.0))
    # d = (0, 2), q = (-2, 0): the control point is (1 - 0.5 * 2, 1 + 0.25 * 2).
    control = np.array([[1.0, 1.0], [0.0, 1.5], [1.0, 3.0]])
    t = np.linspace(0.0, 1.0, 200001)[:, None]
    dense = (1 - t) ** 2 * control[0] + 2 * t * (1 - t) * control[1] + t**2 * control[2]
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(dense, axis=0), axis=1))])
    assert edge_length(panel, 0) == pytest.approx(arc[-1], rel=1e-9)
    points = edge_points(panel, 0, 7)
    wanted = [np.interp(arc[-1] * np.arange(8) / 7, arc, dense[:, k]) for k in (0, 1)]
    assert points == pytest.approx(np.column_stack(wanted), abs=1e-8)


@pytest.mark.parametrize(
    "curve", [Cubic((1.3, 0.4), (-0.3, 0.4)), Cubic((0.0, 0.0), (0.9, 0.5)), Arc(3.0, False, True)]
)
def test_points_are_evenly_spaced_along_the_curve(curve: Any) -> None:
    panel = one_edge(curve)
    points = edge_points(panel, 0, 400)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    # Chords fall short of the arc by (curvature x step)^2 / 24.
    assert steps == pytest.approx(np.full(400, edge_length(panel, 0) / 400), rel=2e-3)
    assert points[0].tolist() == [0.0, 0.0]
    assert points[-1].tolist() == [1.0, 0.0]


def test_round_trip_is_exact(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    corners = tuple(
        (float(x) / 100.0, float(y) / 100.0)
        for x, y in 50 * rng.random((4, 2)) + [[0, 0], [60, 0], [60, 60], [0, 60]]
    )
    curves = (Quadratic((0.5, 0.1)), None, Cubic((0.3, 0.1), (0.7, 0.05)), Arc(2.0, False, True))
    labels = ("", "left_armhole", "", "lower_interface")
    # Roles that labels have, none, and one that its edge's label has not.
    roles: tuple[EdgeRole | None, ...] = ("collar", "armhole", None, "waist")
    edges = tuple(Edge(i, (i + 1) % 4, curves[i], labels[i], roles[i]) for i in range(4))
    panel = Panel(
        name="a",
        vertices=corners,
        edges=edges,
        translation=(0.1, 1.2, -0.3),
        rotation_degrees=(10.0, -20.5, 3.0),
        label="body",
        role="torso",
        warp_degrees=45.0,
    )
    other = Panel(
        name="b", role="sleeve", vertices=corners, edges=tuple(Edge(i, (i + 1) % 4) for i in range(4))
    )
    stitches = (Stitch("a", 0, "b", 1), Stitch("a", 3, "b", 2, right_wrong=True))
    pattern = Pattern(name="drafted", panels=(panel, other), stitches=stitches)
    check_pattern(pattern)
    path = tmp_path / "drafted_specification.json"
    write_garmentcode(pattern, path)
    assert read_garmentcode(path) == pattern
    first = path.read_bytes()
    write_garmentcode(read_garmentcode(path), path)
    assert path.read_bytes() == first


def test_every_real_pattern_reads_and_comes_back(data_dir: Path, tmp_path: Path) -> None:
    paths = sorted(data_dir.glob("patterns/*_specification.json")) + sorted(
        data_dir.glob("reference/*_specification.json")
    )
    assert paths
    for path in paths:
        pattern = read_garmentcode(path)
        copied = tmp_path / path.name
        write_garmentcode(pattern, copied)
        again = read_garmentcode(copied)
        if json.loads(path.read_text())["properties"]["units_in_meter"] == 100:
            assert again == pattern
        assert again.stitches == pattern.stitches
        for one, other in zip(pattern.panels, again.panels, strict=True):
            shape = outline(one, default_segments(one))[0]
            assert outline(other, default_segments(other))[0] == pytest.approx(shape, abs=1e-14)


def panel_of(document: Document, name: str = "left") -> Any:
    return document["pattern"]["panels"][name]


def stitch_of(document: Document) -> Any:
    return document["pattern"]["stitches"]


def bend(document: Document, kind: str, params: list[Any]) -> None:
    panel_of(document)["edges"][0]["curvature"] = {"type": kind, "params": params}


def make_dart_of_strangers(document: Document) -> None:
    """Sew a 20 cm side to a 1 cm side of the same panel."""
    panel = panel_of(document)
    panel["vertices"] = [[0, 0], [20, 0], [20, 20], [19, 20], [0, 19]]
    panel["edges"] = [{"endpoints": [i, (i + 1) % 5]} for i in range(5)]
    document["pattern"]["stitches"] = [[{"panel": "left", "edge": 0}, {"panel": "left", "edge": 2}]]


Spoil = Callable[[Document], Any]
BAD: list[tuple[Spoil, str]] = [
    (lambda d: d.pop("pattern"), "'pattern' is missing"),
    (lambda d: d["pattern"].pop("panels"), "'pattern.panels' is missing"),
    (lambda d: d["pattern"]["panels"].clear(), "'pattern.panels' is empty"),
    (lambda d: d["properties"].update(units_in_meter=-1), "units_in_meter"),
    (lambda d: d["properties"].update(units_in_meter="cm"), "units_in_meter"),
    (lambda d: d.update(properties=[1]), "'properties' must be"),
    (lambda d: panel_of(d)["vertices"].__setitem__(1, [float("nan"), 0]), "panel 'left': vertex 1 .*nan"),
    (lambda d: panel_of(d)["vertices"].__setitem__(1, [1]), "panel 'left': vertex 1 must be a list of 2"),
    (lambda d: panel_of(d).pop("vertices"), "'vertices' must be"),
    (lambda d: panel_of(d).pop("edges"), "'edges' must be"),
    (lambda d: panel_of(d).update(translation=[0, 0]), "panel 'left': translation"),
    (lambda d: panel_of(d)["edges"][2].update(endpoints=[2, 9]), "panel 'left', edge 2: endpoint is 9"),
    (lambda d: panel_of(d)["edges"][2].update(endpoints=[2, 1.5]), "edge 2: endpoint must be a whole"),
    (lambda d: panel_of(d)["edges"][2].update(endpoints=[2]), "edge 2: 'endpoints'"),
    (lambda d: panel_of(d)["edges"].pop(2), "panel 'left' is not a closed loop: edge 1"),
    (lambda d: panel_of(d)["vertices"].__setitem__(2, [20, 0]), "sews panel 'left', edge 1, .* no length"),
    (lambda d: panel_of(d).update(vertices=[[1, 1]] * 4), "none of its edges has a length"),
    (
        lambda d: panel_of(d)["edges"][0].update(endpoints=[1, 1], curvature=[0.5, 0.2]),
        "panel 'left', edge 0 has no length",
    ),
    (lambda d: panel_of(d).update(vertices=[[0, 0], [20, 20], [20, 0], [0, 20]]), "edges 0 and 2 cross"),
    (lambda d: panel_of(d)["edges"][0].update(curvature=[0.5, 2.5]), "edges 0 and 2 cross"),
    (lambda d: bend(d, "cubic", [[1.5, -1], [-0.5, -1]]), "edge 0 crosses itself"),
    (lambda d: bend(d, "spline", []), "type 'spline' is unknown"),
    (lambda d: bend(d, "cubic", [[1, 1]]), "needs 2 control"),
    (lambda d: bend(d, "circle", [5, 0, 1]), "radius 0.05 m"),
    (lambda d: panel_of(d).update(edges=[{"endpoints": [0, 1]}, {"endpoints": [1, 0]}]), "encloses no area"),
    (lambda d: d["pattern"].update(stitches={"a": 1}), "stitches' must be a list"),
    (lambda d: stitch_of(d)[0][1].update(panel="sleeve"), "stitch 0 .* panel 'sleeve', .* left, right"),
    (lambda d: stitch_of(d)[0][1].update(edge=7), "stitch 0: edge is 7, but panel 'right' has only 0..3"),
    (lambda d: stitch_of(d)[0].pop(), "stitch 0 must be two edges"),
    (lambda d: stitch_of(d)[0].append("wrong"), "stitch 0 must be two edges"),
    (lambda d: stitch_of(d)[0].__setitem__(1, {"panel": "left", "edge": 1}), "edge 1 to itself"),
    (lambda d: stitch_of(d).append(copy.deepcopy(stitch_of(d)[0])), r"stitch 1 .* again \(stitch 0 does"),
    (make_dart_of_strangers, r"stitch 0 \(left.0 - left.2\) .* more than 5 to 1"),
]


@pytest.mark.parametrize(("spoil", "message"), BAD, ids=[message for _, message in BAD])
def test_bad_patterns_are_named(spoil: Spoil, message: str, tmp_path: Path) -> None:
    document = two_squares()
    spoil(document)
    with pytest.raises(InputError, match=message) as caught:
        read(document, tmp_path)
    assert "tried_specification.json" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_files_that_are_no_patterns(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such pattern file"):
        read_garmentcode(tmp_path / "none.json")
    path = tmp_path / "broken.json"
    path.write_text("{\n 'a'")
    with pytest.raises(InputError, match=r"broken.json: not valid JSON \(line 2"):
        read_garmentcode(path)
    path.write_text("[1, 2]")
    with pytest.raises(InputError, match="not a GarmentCode"):
        read_garmentcode(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="cannot be read"):
        read_garmentcode(path)


@pytest.mark.parametrize(
    ("name", "label", "role"),
    [
        ("left_sleeve_f", None, "sleeve"),
        ("sl_left_cuff_skirt_b", "arm", "sleeve"),
        ("manche", "arm", "sleeve"),
        ("left_ftorso", "body", "torso"),
        ("slip", "leg", "leg"),
        ("left_hood", None, None),
    ],
)
def test_role_of_a_panel(name: str, label: str | None, role: str | None, tmp_path: Path) -> None:
    document = two_squares()
    panels = document["pattern"]["panels"]
    panels[name] = {**panels["left"], "label": label}
    assert read(document, tmp_path).panel(name).role == role


def test_roles_of_edges(tmp_path: Path) -> None:
    document = two_squares()
    labels = ("lower_interface", "strapless_top", "right_collar", "left_armhole")
    for edge, label in zip(document["pattern"]["panels"]["left"]["edges"], labels, strict=True):
        edge["label"] = label
    document["pattern"]["panels"]["right"]["edges"][0]["label"] = "pocket"
    pattern = read(document, tmp_path)
    roles = [edge.role for edge in pattern.panel("left").edges]
    assert roles == ["waist", "strapless_top", "collar", "armhole"]
    assert {edge.role for edge in pattern.panel("right").edges} == {None}


def test_role_that_the_file_gives_wins(tmp_path: Path) -> None:
    document = two_squares()
    left = document["pattern"]["panels"]["left"]
    left["role"], left["edges"][2]["role"] = "sleeve", "waist"
    panel = read(document, tmp_path).panel("left")
    assert (panel.role, panel.edges[2].role) == ("sleeve", "waist")
    left["edges"][2]["role"] = "knee"
    with pytest.raises(InputError, match=r"panel 'left', edge 2: role must be one of waist, .*got 'knee'"):
        read(document, tmp_path)
