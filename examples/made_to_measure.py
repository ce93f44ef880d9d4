"""Made to measure: the same T-shirt draft on three people, cut anew for each from their measurements.

Run: python examples/made_to_measure.py [FOLDER]
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import toile

PEOPLE = {
    "small": toile.MannequinSize(height=1.55, chest=0.84, waist=0.66, hip=0.90),
    "medium": toile.MannequinSize(height=1.70),
    "large": toile.MannequinSize(height=1.85, chest=1.10, waist=1.00, hip=1.12),
}


def cloth_area(garment: toile.DressedGarment) -> float:
    """Return the area of a garment's panels [m^2]."""
    a, b, c = np.moveaxis(garment.uv[garment.uv_faces], 1, 0)
    return float(0.5 * np.abs(np.linalg.det(np.stack([b - a, c - a], axis=1))).sum())


def main(
    output: str = "out", people: Sequence[str] = tuple(PEOPLE), edge_length: float = 0.024
) -> list[toile.Result]:
    """Dress them, each in a folder of its own, and say how much cloth it took."""
    results = []
    for name in people:
        scene = toile.Scene(
            avatar=PEOPLE[name],
            garments=[toile.Garment("tshirt")],
            quality="preview",
            edge_length=edge_length,
        )
        result = toile.dress(scene, output=Path(output) / name)
        measured = toile.measure(result.avatar)
        print(
            f"{name}: chest {100 * measured.chest:.0f} cm, {cloth_area(result.garments[0]):.2f} m2 of cloth"
        )
        results.append(result)
    return results


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
