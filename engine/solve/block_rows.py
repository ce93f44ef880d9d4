"""Products of rows of 3x3 blocks as SIMD vectors of four numbers."""

from toile.geometry.fours import first_last, four_at, plus_product
from toile.geometry.kernel import helper, unsigned

THREE, FIVE, NINE = unsigned(3), unsigned(5), unsigned(9)


@helper
def block_rows(blocks, k):  # type: ignore[no-untyped-def]
    """Return the rows of block k of (n, 3, 3), laid out as a row of numbers.

    The last is read from the number before it on: nothing beyond the block is.
    """
    at = NINE * k
    return four_at(blocks, at), four_at(blocks, at + THREE), first_last(four_at(blocks, at + FIVE))


@helper
def plus_columns(total, rows, numbers):  # type: ignore[no-untyped-def]
    """Return total plus the transpose of a block times three numbers, of which each comes as four."""
    for k in range(3):
        total = plus_product(total, rows[k], numbers[k])
    return total
