"""Patterns with corners that are there twice, edges without length and corners on straight sides."""

from pathlib import Path

import pytest

from tests.dressing.garment.test_pattern_mesh import areas
from tests.dressing.pattern.test_garmentcode import Document, panel_of, read, two_squares
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.pattern_outline import default_segments, outline, signed_area
from toile.geometry.errors import InputError

REPEATED = [[0, 0], [20, 0], [20, 0], [20, 20], [0, 20]]
"""Corners of a square of which one is there twice [cm]."""


def loop(*corners: int) -> list[Document]:
    return [{"endpoints": [a, b]} for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]


JOINED = [{"endpoints": ends} for ends in ([0, 1], [2, 3], [3, 4], [4, 0])]
POINT = [*loop(0, 1, 3, 4)[:2], {"endpoints": [3, 3]}, *loop(0, 1, 3, 4)[2:]]


@pytest.mark.parametrize(
    ("edges", "sewn", "note"),
    [
        (loop(0, 1, 2, 3, 4), 2, "edge 1 is left out: no length"),
        (POINT, 1, "edge 2 is left out: no length"),
        (JOINED, 1, "corners in one place are joined"),
    ],
)
@pytest.mark.parametrize("as_text", [False, True])
def test_edges_without_length_are_left_out(
    edges: list[Document], sewn: int, note: str, as_text: bool, tmp_path: Path
) -> None:
    """Stitches and seams of the file keep their meaning: they sew the side from (20, 0) to (20, 20)."""
    document = two_squares()
    panel_of(document).update(vertices=REPEATED, edges=edges)
    if as_text:
        document["pattern"] |= {"stitches": [], "seams": [f"left.{sewn} = right.3"]}
    else:
        document["pattern"]["stitches"][0][0]["edge"] = sewn
    pattern = read(document, tmp_path)
    assert pattern.notes == (f"Panel 'left': {note}.",)
    panel = pattern.panel("left")
    assert signed_area(outline(panel, default_segments(panel))[0]) == pytest.approx(0.04)
    side = pattern.seams[0].a[0].edge if as_text else pattern.stitches[0].edge_a
    edge = panel.edges[side]
    assert (panel.vertices[edge.start], panel.vertices[edge.end]) == ((0.2, 0.0), (0.2, 0.2))
    mesh = mesh_pattern(pattern, edge_length=0.05)
    assert len(mesh.stitches) == 5 and areas(mesh).sum() == pytest.approx(0.08)


def test_a_seam_of_an_edge_without_length_is_refused(tmp_path: Path) -> None:
    document = two_squares()
    panel_of(document).update(vertices=REPEATED, edges=loop(0, 1, 2, 3, 4))
    document["pattern"] |= {"stitches": [], "seams": ["left.1 = right.3"]}
    with pytest.raises(InputError, match=r"seams.0 sews panel 'left', edge 1, which has no length; remove"):
        read(document, tmp_path)


def test_corners_on_a_straight_side_stay(tmp_path: Path) -> None:
    document = two_squares()
    panel_of(document).update(
        vertices=[[0, 0], [5, 0], [10, 0], [20, 0], [20, 20], [0, 20]], edges=loop(0, 1, 2, 3, 4, 5)
    )
    document["pattern"]["stitches"][0][0]["edge"] = 3
    pattern = read(document, tmp_path)
    mesh = mesh_pattern(pattern, edge_length=0.05)
    assert pattern.notes == () and len(mesh.stitches) == 5 and areas(mesh).sum() == pytest.approx(0.08)
