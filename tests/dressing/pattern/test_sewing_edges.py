"""Edges in which garments are sewn: like ones for every quality, shorter for small garments."""

import numpy as np
import pytest

from toile.dressing.garment.pattern_mesh import ROUND, mesh_pattern
from toile.dressing.pattern.pattern import Arc, Edge, Panel, Pattern
from toile.dressing.pattern.sewing_edges import COARSEST_SEWN, SEWING_COARSENESS, SEWN, sewing_edges
from toile.dressing.run.quality import COARSEST, QUALITIES, Quality


@pytest.mark.parametrize("quality", QUALITIES.values(), ids=lambda quality: quality.name)
def test_every_quality_is_sewn_in_edges_of_two_to_three_centimetres(quality: Quality) -> None:
    finest = quality.edge_length
    edges = sewing_edges(finest, COARSEST * finest)
    assert SEWN <= edges[0].length < 0.03
    assert [one.curves for one in edges] == pytest.approx([factor * finest for factor in SEWING_COARSENESS])
    # Triangles go as one over the square of the edges: no attempt has a quarter more than the first.
    assert min(one.length for one in edges) > edges[0].length / 1.25**0.5
    assert len(set(edges)) == len(edges)


def test_small_garments_are_sewn_in_short_edges_and_coarse_ones_in_no_shorter_than_asked() -> None:
    assert sewing_edges(0.002, 0.04)[0].length == pytest.approx(COARSEST_SEWN * 0.002)
    assert sewing_edges(0.03, 0.6)[0].length == pytest.approx(SEWING_COARSENESS[0] * 0.03)
    assert max(one.length for one in sewing_edges(0.03, 0.04)) == 0.04


def test_curved_edges_are_cut_into_as_many_sides_as_keep_them_round() -> None:
    """A disc of 20 cm: sides of 28 mm lie 1 mm inside, of 14 mm a quarter of that; straight edges stay."""
    half = Arc(radius=0.1, large=False, right=True)
    disc = Panel(
        name="disc", vertices=((-0.1, 0.0), (0.1, 0.0)), edges=(Edge(0, 1, half), Edge(1, 0, half))
    )  # fmt: skip
    square = Panel(
        name="square", vertices=((0.3, 0.0), (0.5, 0.0), (0.5, 0.2), (0.3, 0.2)),
        edges=tuple(Edge(k, (k + 1) % 4) for k in range(4)),
    )  # fmt: skip
    pattern = Pattern(name="two", panels=(disc, square), stitches=())

    def inside(curves: float) -> float:
        """How far the sides of the disc lie inside its circle, their ends being on it [m]."""
        garment = mesh_pattern(pattern, edge_length=0.028, curve_edge_length=curves)
        assert np.count_nonzero(garment.panel == 1) == squares
        round_faces = garment.faces[garment.panel == 0]
        sides = np.sort(np.concatenate([round_faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
        sides, count = np.unique(sides, axis=0, return_counts=True)
        middles = garment.uv[sides[count == 1]].mean(axis=1)
        return float(0.1 - np.linalg.norm(middles, axis=1).min())

    squares = np.count_nonzero(mesh_pattern(pattern, edge_length=0.028).panel == 1)
    assert inside(0.028) == pytest.approx(0.1 * (1.0 - np.cos(np.pi / 24)), rel=1e-6)
    assert inside(0.020) == pytest.approx(0.1 * (1.0 - np.cos(np.pi / 32)), rel=1e-6)
    assert 0.8 * ROUND < inside(0.010) <= ROUND
