"""Dress the built-in mannequin in a built-in T-shirt: python examples/dress_mannequin.py [FOLDER]."""

import sys

import toile


def main(output: str = "out", quality: str = "standard", max_frames: int | None = None) -> toile.Result:
    """Drape a T-shirt that is drafted to the mannequin, write all files and print how it ended."""
    scene = toile.Scene(
        avatar=toile.MannequinSize(height=1.75, chest=0.96, waist=0.80, hip=1.00),
        garments=[toile.Garment("tshirt", fabric="cotton-interlock")],
        quality=quality,
        max_frames=max_frames,
    )
    result = toile.dress(scene, output=output, say=print)
    crossings = result.report["intersections"]
    print(f"{result.status}: {crossings['avatar']} body and {crossings['self']} self intersections")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
