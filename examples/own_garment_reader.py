"""A garment format of one's own: panels drawn as polygons in SVG, which any drawing program opens.

A polygon's id names its panel; data-z is how far in front of the body it starts [mm], and data-sewn names the
seam of each of its edges: those of one name are sewn. Run: python examples/own_garment_reader.py [FOLDER]
"""

import sys
from pathlib import Path
from xml.etree import ElementTree

import toile

OUTLINE = "-480,-880 480,-880 480,-1180 190,-1450 90,-1490 0,-1400 -90,-1490 -190,-1450 -480,-1180"
BACKWARDS = " ".join(reversed(OUTLINE.split()))
DRAWING = f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="-500 -1500 1000 700">
<polygon id="front" data-z="190" data-sewn="- - arm_l top_l - - top_r arm_r -" points="{OUTLINE}"/>
<polygon id="back" data-z="-190" data-sewn="arm_r top_r - - top_l arm_l - - -" points="{BACKWARDS}"/>
</svg>"""


def read_svg(path: Path) -> toile.Pattern:
    """Return the pattern of an SVG file in millimetres, y down. Raises InputError naming what is wrong."""
    try:
        polygons = ElementTree.parse(path).iter("{http://www.w3.org/2000/svg}polygon")
    except ElementTree.ParseError as error:
        raise toile.InputError(f"{path}: not valid SVG ({error}); save the drawing again") from None
    panels, seams = [], dict[str, list[tuple[str, int]]]()
    for polygon in polygons:
        name, z = polygon.get("id", "panel"), float(polygon.get("data-z", "0"))
        numbers = [1e-3 * float(number) for number in polygon.get("points", "").replace(",", " ").split()]
        corners = tuple((x, -y) for x, y in zip(numbers[::2], numbers[1::2], strict=True))
        sewn = polygon.get("data-sewn", "").split()
        if len(sewn) != len(corners):
            raise toile.InputError(f"{path}: '{name}' has {len(corners)} edges, data-sewn names {len(sewn)}")
        for edge, seam in enumerate(sewn):
            if seam != "-":
                seams.setdefault(seam, []).append((name, edge))
        edges = tuple(toile.Edge(i, (i + 1) % len(corners)) for i in range(len(corners)))
        place = (0.0, 0.0, 1e-3 * z)
        panels.append(toile.Panel(name=name, vertices=corners, edges=edges, translation=place))
    stitches = tuple(toile.Stitch(*sides[0], *sides[-1]) for sides in seams.values())
    return toile.Pattern(name=path.stem, panels=tuple(panels), stitches=stitches)


def main(output: str = "out", edge_length: float | None = None) -> toile.Result:
    """Draw the pattern, register the reader and dress the mannequin in what it reads."""
    Path(output).mkdir(parents=True, exist_ok=True)
    (Path(output) / "poncho.svg").write_text(DRAWING)
    toile.register_reader(".svg", read_svg)
    garment = toile.Garment(Path(output) / "poncho.svg", fabric="cotton-poplin")
    scene = toile.Scene(garments=[garment], quality="preview", edge_length=edge_length)
    return toile.dress(scene, output, say=print)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
