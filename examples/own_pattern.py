"""A tunic of one's own: two panels by their corners, four seams by the numbers of their edges.

The pattern is written as GarmentCode JSON and put on the built-in mannequin.
Run: python examples/own_pattern.py [FOLDER]
"""

import sys
from pathlib import Path

import toile

CORNERS = (
    (-0.34, 0.80), (0.34, 0.80), (0.26, 1.19), (0.19, 1.40), (0.09, 1.45), (0.0, 1.36),
    (-0.09, 1.45), (-0.19, 1.40), (-0.26, 1.19),
)  # fmt: skip
"""Hem, side, armhole, shoulder, neck and down the other side, from the front [m]; feet are at y = 0."""
SEWN = (1, 3, 6, 8)
"""Edges of the front that are sewn to the back: edge i runs from corner i to the next."""


def panel(name: str, corners: tuple[tuple[float, float], ...], z: float) -> toile.Panel:
    """Return a panel upright at z [m]; corners that run clockwise turn its right side to the back."""
    edges = tuple(toile.Edge(i, (i + 1) % len(corners)) for i in range(len(corners)))
    return toile.Panel(name=name, vertices=corners, edges=edges, translation=(0.0, 0.0, z), label="body")


def tunic() -> toile.Pattern:
    """Return the pattern: the back has the corners of the front in the opposite order."""
    front, back = panel("front", CORNERS, 0.18), panel("back", CORNERS[::-1], -0.18)
    seams = tuple(toile.Stitch("front", i, "back", (len(CORNERS) - 2 - i) % len(CORNERS)) for i in SEWN)
    return toile.Pattern(name="tunic", panels=(front, back), stitches=seams)


def main(output: str = "out", edge_length: float | None = None) -> toile.Result:
    """Write the pattern, dress the mannequin in it and write what comes of it."""
    Path(output).mkdir(parents=True, exist_ok=True)
    file = Path(output) / "tunic_specification.json"
    toile.write_garmentcode(tunic(), file)
    garment = toile.Garment(file, fabric="wool-worsted")
    scene = toile.Scene(garments=[garment], quality="preview", edge_length=edge_length)
    result = toile.dress(scene, output=output, say=print)
    print(f"{result.status}: {result.report['intersections']['self']} crossings")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
