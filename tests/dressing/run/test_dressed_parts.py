"""Garments with gas and elastic from panels to the drape: sewn flat, filled and drawn in then."""

from pathlib import Path

import numpy as np
import pytest

import toile
from toile.dressing.pattern import drafts
from toile.geometry.arrays import Float

SIDE = 0.2
FREE = 0.008
"""Volume of the gas outside [m^3]."""


def pillow(body: toile.Measurements) -> toile.Pattern:
    """Two squares in front of the body, sewn all around; the upper edge is to be pinned."""
    low, high = body.waist_height - SIDE, body.waist_height + SIDE
    corners = ((-SIDE, low), (SIDE, low), (SIDE, high), (-SIDE, high))
    edges = tuple(toile.Edge(i, (i + 1) % 4, label="hang" if i == 2 else "") for i in range(4))
    front = body.torso_depth[1]
    panels = (
        toile.Panel(name="front", vertices=corners, edges=edges, translation=(0.0, 0.0, front + 0.25)),
        toile.Panel(
            name="back", vertices=corners[::-1], edges=tuple(toile.Edge(i, (i + 1) % 4) for i in range(4)),
            translation=(0.0, 0.0, front + 0.2),
        ),
    )  # fmt: skip
    seams = tuple(toile.Stitch("front", i, "back", (2 - i) % 4) for i in range(4))
    return toile.Pattern(name="pillow", panels=panels, stitches=seams)


def volume(garment: toile.DressedGarment) -> float:
    corner: Float = garment.positions[garment.faces]
    return float(np.einsum("ti,ti->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2]))) / 6.0


def test_a_pillow_is_sewn_and_holds_its_gas(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(drafts, "_DRAFTS", {**drafts._DRAFTS, "pillow": pillow})
    garment = toile.Garment("pillow", pins=("hang",), gas=toile.Filling(volume=FREE))
    result = toile.dress(toile.Scene(garments=[garment], quality="preview", edge_length=0.04))
    assert result.status == "converged"
    assert result.report["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    # Slack, its gas has hardly any overpressure: the weight of poplin is 1.2 Pa.
    assert volume(result.garments[0]) == pytest.approx(FREE, rel=1e-3)
