"""Cloth that blocks the avatar is given its motion; cloth that is farther away or blocks nothing is not."""

import numpy as np
import pytest

from toile.collide.carry import carried_along

NO_PAIRS = np.empty((0, 4), np.int32)


def test_nodes_that_block_move_along_by_the_longest_motion() -> None:
    # Rows 0-2: a cloth face at z = 1 mm; rows 3-5: avatar vertices below it.
    p = np.array(
        [
            (0.0, 0.0, 1e-3),
            (1.0, 0.0, 1e-3),
            (0.0, 1.0, 1e-3),
            (0.2, 0.2, 0.0),
            (0.3, 0.2, 0.0),
            (0.2, 0.3, 0.0),
        ]
    )
    move = np.zeros_like(p)
    move[3:, 2] = [0.001, 0.003, 0.002]
    pairs = np.array([(3, 0, 1, 2), (4, 0, 1, 2), (5, 0, 1, 2)], np.int32)

    def carried(blocked: list[int], reach: float) -> float:
        mask = np.zeros(6, bool)
        mask[blocked] = True
        found = carried_along(p, move, mask, pairs, NO_PAIRS, 3, reach)
        assert found.shape == (3, 3) and np.ptp(found, axis=0) == pytest.approx(0.0, abs=1e-15)
        return float(found[0, 2])

    assert carried([3], 2e-3) == 0.001
    assert carried([3, 4, 5], 2e-3) == 0.003
    assert carried([], 2e-3) == 0.0
    assert carried([3, 4, 5], 0.5e-3) == 0.0


def test_edges_carry_each_other() -> None:
    p = np.array([(-1.0, 0.0, 1e-3), (1.0, 0.0, 1e-3), (0.0, -1.0, 0.0), (0.0, 1.0, 0.0)])
    move = np.zeros_like(p)
    move[2:] = (0.0, 0.001, 0.002)
    blocked = np.array([False, False, True, False])
    found = carried_along(p, move, blocked, NO_PAIRS, np.array([(0, 1, 2, 3)], np.int32), 2, 2e-3)
    assert np.array_equal(found, move[2:])
