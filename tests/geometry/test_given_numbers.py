"""Numbers that users give, where they are larger than any that can be meant."""

import pytest

from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, real, shown, whole


@pytest.mark.parametrize("digits", [310, 5000])
def test_whole_numbers_beyond_all_bounds_are_named(digits: int) -> None:
    huge = 10**digits
    assert not is_real(huge)
    assert len(shown(huge)) < 80
    with pytest.raises(InputError, match="fps must be a number, got "):
        real(huge, "fps", 0.0, 1e4)
    with pytest.raises(InputError, match="count must lie between 1 and 10, got "):
        whole(huge, "count", 1, 10)


def test_large_numbers_that_can_be_meant_are_numbers() -> None:
    assert is_real(10**300)
    assert real(10**3, "fps", 0.0, 1e4) == 1000.0
