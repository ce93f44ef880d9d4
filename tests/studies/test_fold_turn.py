"""Turn of folded surfaces against what is known of them, on any mesh."""

import numpy as np
import pytest

from toile.studies.adaptive.fold_turn import fold_turn
from toile.studies.scenes.flat_meshes import KINDS, mesh

HEIGHT, WAVE = 0.01, 0.1
"""Waves [m] that turn by some 32 degrees to either side."""


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 4])
def test_waves_turn_by_what_their_slope_says(kind: str, angle: float) -> None:
    """From crest to trough and back the normal turns by four times the steepest slope, on any mesh."""
    points, faces = mesh(kind, 4.0 * WAVE, 4.0 * WAVE, 0.02)
    along = points @ (np.cos(angle), np.sin(angle))
    waves = np.column_stack([points, HEIGHT * np.sin(2.0 * np.pi * along / WAVE)])
    slope = 2.0 * np.pi * HEIGHT / WAVE * np.cos(np.linspace(0.0, 2.0 * np.pi, 10001))
    length = WAVE * np.mean(np.sqrt(1.0 + slope**2))
    assert fold_turn(waves, faces) == pytest.approx(4.0 * np.arctan(slope.max()) / length, rel=0.08)


def test_a_seam_turns_though_its_sides_share_no_vertex() -> None:
    points, faces = mesh("equilateral", 0.6, 0.3, 0.02)
    u, v = points.T
    whole = np.column_stack([np.sin(5.0 * u) / 5.0, v, np.cos(5.0 * u) / 5.0])
    loose = whole[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)
    for surface in (whole, faces), loose:
        assert fold_turn(*surface) == pytest.approx(5.0, rel=0.02)


def test_a_flat_sheet_does_not_turn() -> None:
    points, faces = mesh("random", 1.0, 1.0, 0.1)
    assert fold_turn(np.pad(points, ((0, 0), (0, 1))), faces) == pytest.approx(0.0, abs=1e-6)
