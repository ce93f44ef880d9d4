"""Seams between runs of edges: their text, splitting at corners and notches, what cannot be sewn."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.garmentcode import check_pattern, read_garmentcode
from toile.dressing.pattern.garmentcode_write import write_garmentcode
from toile.dressing.pattern.pattern import (
    Arc,
    Cubic,
    Curve,
    Edge,
    Panel,
    Pattern,
    Polyline,
    Quadratic,
    Stitch,
)
from toile.dressing.pattern.pattern_curve import cut_curve, edge_length, edge_points
from toile.dressing.pattern.pattern_outline import default_segments, outline, signed_area
from toile.dressing.pattern.seam import EdgePart, read_seam
from toile.dressing.pattern.split_seams import split_seams
from toile.geometry.errors import InputError


def rectangle(name: str, width: float, height: float, x: float = 0.0, curve: Curve = None) -> Panel:
    """A rectangle whose bottom edge, number 0, may be curved."""
    edges = (Edge(0, 1, curve), *(Edge(i, (i + 1) % 4) for i in (1, 2, 3)))
    corners = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height))
    return Panel(name=name, vertices=corners, edges=edges, translation=(x, 1.0, 0.3))


def sewn(*seams: str, **notches: tuple[float, ...]) -> Pattern:
    """A wide panel over two narrow ones, 60 and 40 cm."""
    panels = [
        rectangle("wide", 1.0, 0.3), rectangle("left", 0.6, 0.3, 1.2), rectangle("right", 0.4, 0.3, 2.0),
    ]  # fmt: skip
    for index, panel in enumerate(panels):
        edges = list(panel.edges)
        number = 0 if panel.name == "wide" else 2
        edges[number] = replace(edges[number], notches=notches.get(panel.name, ()))
        panels[index] = replace(panel, edges=tuple(edges))
    return Pattern(
        name="t", panels=tuple(panels), stitches=(), seams=tuple(read_seam(text, "t") for text in seams)
    )


def test_text_of_a_seam_says_edges_parts_and_directions() -> None:
    seam = read_seam("front.3 + -back.2[0.5:] = my sleeve.10[:0.25]", "x")
    assert seam.a == (EdgePart("front", 3, 0.0, 1.0), EdgePart("back", 2, 1.0, 0.5))
    assert seam.b == (EdgePart("my sleeve", 10, 0.25, 0.0),)
    assert read_seam(seam.name, "x") == seam


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("front.1", "only one side"),
        ("front.1 =", "only one side"),
        ("a.1 = b.1 = c.1", "more than two sides"),
        ("front = back.1", "'front' is no edge"),
        ("front.1[0.5] = back.1", "is no edge"),
        ("front.1[0.8:0.2] = back.1", "from a smaller to a larger"),
        ("front.1[a:] = back.1", "two fractions"),
    ],
)
def test_texts_that_are_no_seam_are_refused(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as raised:
        read_seam(text, "scene.toml")
    assert "\n" not in str(raised.value) and str(raised.value).startswith("scene.toml")


def test_both_sides_are_split_at_the_partners_corners() -> None:
    pattern = split_seams(sewn("wide.0 = right.2 + left.2"))
    check_pattern(pattern)
    assert pattern.seams == ()
    assert [s.name for s in pattern.stitches] == ["wide.0 - right.2", "wide.1 - left.2"]
    assert [edge_length(pattern.panel("wide"), n) for n in range(5)] == pytest.approx(
        [0.4, 0.6, 0.3, 1.0, 0.3]
    )
    assert not any(stitch.right_wrong for stitch in pattern.stitches)


def test_stitched_vertices_of_a_split_seam_face_each_other_in_order() -> None:
    mesh = mesh_pattern(sewn("wide.0 = right.2 + left.2"), edge_length=0.05)
    a, b = (mesh.uv[mesh.stitches[:, side], 0] for side in (0, 1))
    first = mesh.seam == 0
    assert a[first] == pytest.approx(b[first])
    assert a[~first] - 0.4 == pytest.approx(b[~first])


def test_a_part_of_an_edge_leaves_the_rest_open() -> None:
    pattern = split_seams(sewn("wide.0[0.2:0.6] = right.2"))
    (stitch,) = pattern.stitches
    assert (stitch.panel_a, stitch.edge_a, stitch.panel_b, stitch.edge_b) == ("wide", 1, "right", 2)
    assert [edge_length(pattern.panel("wide"), n) for n in range(3)] == pytest.approx([0.2, 0.4, 0.4])


def test_turned_edges_sew_right_to_wrong() -> None:
    assert split_seams(sewn("wide.0[:0.4] = -right.2")).stitches[0].right_wrong


def test_notches_meet_and_share_out_the_ease_between_them() -> None:
    pattern = split_seams(sewn("wide.0 = left.2", wide=(0.5,), left=(0.55,)))
    wide, left = pattern.panel("wide"), pattern.panel("left")
    # Against the loop: the notch of the left panel is 45 % along the seam.
    lengths = [(edge_length(wide, s.edge_a), edge_length(left, s.edge_b)) for s in pattern.stitches]
    assert lengths == [pytest.approx((0.5, 0.27)), pytest.approx((0.5, 0.33))]


def test_notches_that_do_not_pair_up_are_left_alone() -> None:
    assert len(split_seams(sewn("wide.0 = left.2", wide=(0.5,), left=(0.2, 0.8))).stitches) == 1
    assert len(split_seams(sewn("wide.0 = left.2", wide=(0.2,), left=(0.2,))).stitches) == 1


def test_a_pattern_without_seams_comes_back_as_it_is() -> None:
    pattern = replace(sewn(), stitches=(Stitch("wide", 0, "left", 2),))
    assert split_seams(pattern) is pattern


@pytest.mark.parametrize(
    ("seams", "said"),
    [
        (("wide.0 = lefd.2",), "unknown panel 'lefd'.*left"),
        (("wide.9 = left.2",), r"panel 'wide' has no edge 9, only 0\.\.3"),
        (("wide.0 = left.2", "wide.0[0.9:] = right.2"), r"overlap on wide\.0"),
        (("wide.0 = left.2 + left.2",), r"overlap on left\.2"),
        (("wide.0[0:0.02] = left.2",), "more than 12 to 1"),
    ],
)
def test_seams_that_cannot_be_sewn_are_refused(seams: tuple[str, ...], said: str) -> None:
    with pytest.raises(InputError, match=said) as raised:
        check_pattern(sewn(*seams))
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    "curve",
    [
        None,
        Quadratic((0.4, 0.3)),
        Cubic((0.2, 0.4), (0.9, -0.2)),
        Arc(0.6, False, True),
        Arc(0.55, True, False),
        Polyline(((0.3, 0.1), (0.7, 0.15))),
    ],
)
def test_pieces_of_a_cut_edge_lie_on_it(curve: Curve) -> None:
    panel = rectangle("p", 1.0, 0.5, curve=curve)
    whole, fractions = edge_length(panel, 0), [0.2, 0.65]
    start, found = (0.0, 0.0), []
    for (piece, end), share in zip(
        cut_curve(panel, 0, fractions), np.diff([0.0, *fractions, 1.0]), strict=True
    ):
        own = Panel(name="", vertices=(start, end), edges=(Edge(0, 1, piece),))
        assert edge_length(own, 0) == pytest.approx(share * whole, rel=1e-6)
        found.append(edge_points(own, 0, 1000))
        start = end
    assert start == (1.0, 0.0)
    dense = edge_points(panel, 0, 4000)
    for points in found:
        assert np.linalg.norm(points[:, None] - dense[None], axis=2).min(axis=1).max() < 2e-4 * whole + 1e-9


def test_polylines_are_written_as_curves_with_seams_split(tmp_path: Path) -> None:
    angles = np.linspace(0.0, math.pi, 40)[1:-1]
    half_round = Polyline(tuple((0.5 - 0.5 * math.cos(a), -0.5 * math.sin(a)) for a in angles))
    pattern = replace(sewn(), panels=(rectangle("wide", 1.0, 0.3, curve=half_round), *sewn().panels[1:]))
    pattern = replace(pattern, seams=(read_seam("wide.0 = right.2 + left.2", "t"),))
    write_garmentcode(pattern, tmp_path / "p_specification.json")
    back = read_garmentcode(tmp_path / "p_specification.json")
    assert not any(isinstance(edge.curve, Polyline) for panel in back.panels for edge in panel.edges)
    areas = [
        signed_area(outline(p.panel("wide"), default_segments(p.panel("wide"), 400))[0])
        for p in (pattern, back)
    ]
    assert areas[1] == pytest.approx(areas[0], rel=1e-3)
    whole = sum(edge_length(back.panel("wide"), s.edge_a) for s in back.stitches)
    assert whole == pytest.approx(edge_length(pattern.panel("wide"), 0), rel=1e-3)


def test_garmentcode_files_may_hold_seams(tmp_path: Path) -> None:
    write_garmentcode(sewn(), tmp_path / "p_specification.json")
    document = json.loads((tmp_path / "p_specification.json").read_text())
    document["pattern"]["seams"] = ["wide.0 = right.2 + left.2"]
    (tmp_path / "p_specification.json").write_text(json.dumps(document))
    assert len(split_seams(read_garmentcode(tmp_path / "p_specification.json")).stitches) == 2
