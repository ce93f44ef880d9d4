"""Two layers: trousers, and a T-shirt that hangs over them. Garments are listed from the body outwards.

Run: python examples/layers.py [FOLDER]
"""

import sys

import toile


def main(output: str = "out", edge_length: float | None = None) -> toile.Result:
    """Dress the mannequin in both, of different fabrics, and write what comes of it."""
    scene = toile.Scene(
        garments=[
            toile.Garment("trousers", fabric="denim-12oz"),
            toile.Garment("tshirt", fabric="cotton-interlock"),
        ],
        friction_between={("denim-12oz", "cotton-interlock"): 0.3},
        quality="preview",
        edge_length=edge_length,
    )
    result = toile.dress(scene, output=output, say=print)
    print(f"{result.status}: nearest {result.report['min_gap_mm']:.2f} mm, crossings", end=" ")
    print(result.report["intersections"]["self"])
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
