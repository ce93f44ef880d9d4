"""Half a waistband: a rectangle whose lower edge is divided where the seams of the garment below arrive."""

from toile.dressing.pattern.drafts.drafting import Side


def band_sides(pieces: tuple[float, ...], height: float) -> tuple[Side, ...]:
    """Outline of a band, counter-clockwise, symmetric about x = 0, its lower edge at y = 0.

    `pieces` are the lengths [m] of the lower edges of the left half, from the middle outwards; they become
    sides "left_lower_0", "left_lower_1" ... with label "lower_interface"; then follow "left_end", "top" and
    the same on the right.
    """
    lower, x = [], 0.0
    for index, piece in enumerate(pieces):
        lower.append(
            Side(
                name=f"left_lower_{index}",
                start=(x, 0.0),
                end=(x + piece, 0.0),
                label="lower_interface",
                role="waist",
            )
        )
        x += piece
    left = [*lower, Side(name="left_end", start=(x, 0.0), end=(x, height))]
    right = [side.mirrored().backwards() for side in reversed(left)]
    top = Side(name="top", start=(x, height), end=(-x, height))
    return (*left, top, *right)
