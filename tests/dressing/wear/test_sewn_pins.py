"""Pins of patterns take hold once their seams are closed."""

import numpy as np

import toile


def test_a_skirt_pinned_at_its_waist_is_sewn_and_hangs_from_there() -> None:
    """The example of `toile.Garment`: pinned from the start, its flat waistband would never close."""
    body = toile.mannequin()
    scene = toile.Scene(
        garments=[toile.Garment("circle_skirt", pins=["lower_interface"])], avatar=body, quality="preview",
        edge_length=0.05, remesh=False,
    )  # fmt: skip
    result = toile.dress(scene)
    assert result.status == "converged", result.failure
    (skirt,) = result.garments
    top = skirt.positions[:, 1].max()
    assert abs(top - toile.measure(body).waist_height) < 0.06
    around = skirt.positions[skirt.positions[:, 1] > top - 0.03]
    angles = np.sort(np.arctan2(around[:, 2], around[:, 0]))
    assert np.diff(angles, append=angles[0] + 2 * np.pi).max() < np.radians(45.0), "the waist is a ring"
