"""A draft of one's own: an A-line skirt from the measurements of who wears it, named like a built-in one.

Run: python examples/own_draft.py [FOLDER]
"""

import sys

import toile


def a_line_skirt(body: toile.Measurements) -> toile.Pattern:
    """Return a skirt to the knee: waist plus 1 cm at the top, hip plus 30 cm at the hem, two panels."""
    top, hem = body.waist_height, 0.29 * body.height
    waist, hip, wide = (0.25 * girth for girth in (body.waist + 0.01, body.hip + 0.06, body.hip + 0.30))
    level = body.hip_height
    corners = ((-wide, hem), (wide, hem), (hip, level), (waist, top), (-waist, top), (-hip, level))
    back, front = body.torso_depth
    # The label has the waistband kept at its height until friction can hold it.
    waistband = {("front", 3): "lower_interface", ("back", 1): "lower_interface"}
    panels = tuple(
        toile.Panel(
            name=name, vertices=points, translation=(0.0, 0.0, z), label="leg",
            edges=tuple(toile.Edge(i, (i + 1) % 6, label=waistband.get((name, i), "")) for i in range(6)),
        )
        for name, points, z in (("front", corners, front + 0.06), ("back", corners[::-1], back - 0.06))
    )  # fmt: skip
    seams = tuple(toile.Stitch("front", i, "back", (4 - i) % 6) for i in (1, 2, 4, 5))
    return toile.Pattern(name="a_line_skirt", panels=panels, stitches=seams)


def main(output: str = "out", edge_length: float | None = None) -> toile.Result:
    """Register the draft, dress the mannequin in it and write what comes of it."""
    toile.register_draft("a_line_skirt", a_line_skirt)
    body = toile.MannequinSize(height=1.68, waist=0.72, hip=1.02)
    garment = toile.Garment("a_line_skirt", fabric="denim-12oz")
    scene = toile.Scene(avatar=body, garments=[garment], quality="preview", edge_length=edge_length)
    result = toile.dress(scene, output=output, say=print)
    print(f"{result.status}: the hem is at {100 * result.garments[0].positions[:, 1].min():.0f} cm")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
