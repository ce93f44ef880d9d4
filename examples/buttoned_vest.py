"""A close vest with six buttons, open to the third from the top, and a pocket, over the mannequin.

A back and two fronts that overlap by 3 cm; the left one lies on top. Rows close from where they begin, here
from the hem. Run: python examples/buttoned_vest.py [FOLDER]
"""

import sys

import toile

BUTTONS, CLOSED = 6, 4
OVERLAP = 0.03
"""By how much the fronts overlap [m]; buttons sit in the middle of that."""
POCKET = ((0.0, 0.0), (0.1, 0.0), (0.1, 0.12), (0.0, 0.12))


def vest(body: toile.Measurements) -> toile.Pattern:
    """Return a back and two fronts from the hip to the shoulders, sewn along sides and shoulders."""
    wide, narrow = 0.25 * body.hip, 0.25 * body.chest - 0.01
    hem, arm = body.hip_height, body.armpit_height - 0.04
    tip = (body.shoulder_point[0], body.shoulder_point[1] + 0.01)
    neck = (0.5 * body.neck_width + 0.025, body.neck_height + 0.005)
    top, half = body.armpit_height + 0.04, 0.5 * OVERLAP
    left = ((-half, hem), (wide, hem), (narrow, arm), tip, neck, (-half, top))
    right = tuple((-x, y) for x, y in (left[1], left[0], left[5], left[4], left[3], left[2]))
    back = (
        *((wide, hem), (-wide, hem), (-narrow, arm), (-tip[0], tip[1])),
        *((-neck[0], neck[1]), neck, tip, (narrow, arm)),
    )
    behind, ahead = (z + gap for z, gap in zip(body.torso_depth, (-0.04, 0.04), strict=True))

    def panel(
        name: str, points: tuple[tuple[float, float], ...], z: float, necks: tuple[int, ...]
    ) -> toile.Panel:
        count = len(points)
        return toile.Panel(
            name=name, vertices=points, translation=(0.0, 0.0, z), label="body", role="torso",
            edges=tuple(
                toile.Edge(i, (i + 1) % count, role="collar" if i in necks else None) for i in range(count)
            ),
        )  # fmt: skip

    panels = (panel("left", left, ahead + 0.012, (4,)), panel("right", right, ahead, (2,)),
              panel("back", back, behind, (4,)), panel("pocket", POCKET, ahead + 0.05, ()))  # fmt: skip
    seams = (
        toile.Stitch("left", 1, "back", 7), toile.Stitch("left", 3, "back", 5),
        toile.Stitch("right", 5, "back", 1), toile.Stitch("right", 3, "back", 3),
    )  # fmt: skip
    return toile.Pattern(name="vest", panels=panels, stitches=seams)


def main(output: str = "out", edge_length: float | None = None, quality: str = "preview") -> toile.Result:
    """Register the draft and dress the mannequin in it."""
    toile.register_draft("vest", vest)
    # The left front is walked up from the hem, and so is the right one.
    buttons = toile.Closure(
        kind="buttons", over="-left.5", under="-right.1", count=BUTTONS, inset=0.5 * OVERLAP, ends=0.03,
        closed=CLOSED / BUTTONS,
    )  # fmt: skip
    # Three edges of the pocket, down, across and up; the vest hangs above the floor as it is drawn.
    pocket = toile.Patch(run="pocket.3 + pocket.0 + pocket.1", onto="left", at=(0.06, 0.93))
    garment = toile.Garment("vest", fabric="cotton-poplin", closures=(buttons,), patches=(pocket,))
    scene = toile.Scene(garments=[garment], quality=quality, edge_length=edge_length)
    result = toile.dress(scene, output=output, say=print)
    print(f"{result.status}: {CLOSED} of {BUTTONS} buttons are closed")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
