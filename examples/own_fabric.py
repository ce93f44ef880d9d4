"""A fabric of one's own, by its numbers in SI units: the same circle skirt in silk and in stiff felt.

Run: python examples/own_fabric.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

import toile

FELT = toile.Fabric(
    name="felt", areal_density=0.30, thickness=2e-3,
    bending_warp=2e-4, bending_weft=2e-4, bending_bias=2e-4,  # [N m]
    stretch_warp=1500.0, stretch_weft=1500.0, shear=600.0,  # [N/m]
    friction_body=0.4, friction_self=0.5,
)  # fmt: skip


def hem_area(garment: toile.DressedGarment) -> float:
    """Return the area of the shadow that a garment casts from above [m^2], by its width in all directions."""
    angles = np.linspace(0.0, np.pi, 180, endpoint=False)
    across = garment.positions[:, [0, 2]] @ np.array([np.cos(angles), np.sin(angles)])
    return float(np.pi / 4 * np.ptp(across, axis=0).mean() ** 2)


def main(output: str = "out", edge_length: float = 0.024) -> list[toile.Result]:
    """Dress the mannequin in both skirts, each in a folder of its own, and say how wide they hang."""
    results = []
    for fabric in (toile.fabric("silk-charmeuse"), FELT):
        scene = toile.Scene(
            garments=[toile.Garment("circle_skirt", fabric=fabric)], quality="preview",
            edge_length=edge_length,
        )  # fmt: skip
        result = toile.dress(scene, output=Path(output) / fabric.name)
        print(f"{fabric.name}: {result.status}, shadow {hem_area(result.garments[0]):.2f} m2")
        results.append(result)
    return results


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
