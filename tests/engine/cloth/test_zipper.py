import numpy as np
import pytest

from toile.engine.cloth.zipper import zipper_distance


def test_distance_runs_along_the_seam_from_the_nearest_junction() -> None:
    """Seam 0 bends and meets seam 1 at its end (node 2); seam 2 meets nobody."""
    positions = np.zeros((13, 3))
    positions[[0, 1, 2]] = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.3, 0.1, 0.0)]
    positions[7] = (0.3, 0.1, 0.5)
    positions[[9, 11]] = [(5.0, 0.0, 0.0), (6.0, 0.0, 0.0)]
    stitches = np.array([(0, 3), (1, 4), (2, 5), (2, 6), (7, 8), (9, 10), (11, 12)], np.int32)
    seam = np.array([0, 0, 0, 1, 1, 2, 2], np.int32)
    weld = np.array([0, 1, 2, 0, 1, 2, 2, 3, 3, 4, 4, 5, 5], np.int32)
    found = zipper_distance(positions, stitches, seam, weld)
    assert found == pytest.approx([0.4, 0.1, 0.0, 0.0, 0.5, 0.0, 0.0])


def test_between_two_junctions_the_middle_closes_last() -> None:
    positions = np.zeros((10, 3))
    positions[:5, 0] = np.arange(5)
    stitches = np.array([(k, k + 5) for k in range(5)] + [(0, 5), (4, 9)], np.int32)
    seam = np.array([0] * 5 + [1, 2], np.int32)
    weld = np.tile(np.arange(5, dtype=np.int32), 2)
    assert zipper_distance(positions, stitches, seam, weld)[:5].tolist() == [0.0, 1.0, 2.0, 1.0, 0.0]
