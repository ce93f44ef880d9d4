"""Four numbers at once are what four numbers one by one are, to the last bit."""

import numpy as np
from numba import types

from toile.geometry import fours
from toile.geometry.kernel import F64_1, OUT_F64_1, kernel


@kernel(types.UniTuple(types.float64, 3)(F64_1, types.float64, OUT_F64_1))
def every_operation(numbers, factor, out):  # type: ignore[no-untyped-def]
    one, other = fours.four_at(numbers, 1), fours.first_last(fours.four_at(numbers, 3))
    total = fours.plus_product(
        fours.plus_product(fours.four_times(factor), one, other), one, fours.four_times(factor)
    )
    fours.put_four(out, 2, fours.plus_three(total, 1.5, 2.5, 3.5))
    return fours.three_of(other)


def test_operations_equal_those_of_single_numbers() -> None:
    numbers = np.random.default_rng(0).normal(size=7)
    out = np.zeros(7)
    factor = 0.37
    three = every_operation(numbers, factor, out)
    assert three == (numbers[4], numbers[5], numbers[6])
    others = (numbers[4], numbers[5], numbers[6], numbers[3])
    added = (1.5, 2.5, 3.5, 0.0)
    for lane in range(4):
        one = numbers[1 + lane]
        assert out[2 + lane] == ((factor + one * others[lane]) + one * factor) + added[lane]
    assert not out[[0, 1, 6]].any()
