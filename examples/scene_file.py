"""A scene without Python: bodies, garments and fabrics in a TOML file, as `toile dress scene.toml` takes it.

Run: python examples/scene_file.py [FOLDER]
"""

import sys
from pathlib import Path

import toile

SCENE = """\
quality = "preview"

[avatar]                     # the built-in mannequin; or file = "body.obj"
height = 1.75
chest = 0.96

[[garment]]                  # from the body outwards
source = "trousers"
fabric = "my linen"

[fabric."my linen"]          # every value in SI units; those not given are the preset's
like = "cotton-poplin"
areal_density = 0.19
bending_warp = 2.5e-5
"""


def main(output: str = "out", settings: str = "") -> toile.Result:
    """Write the scene file, with `settings` in front, and dress the mannequin as it says."""
    Path(output).mkdir(parents=True, exist_ok=True)
    file = Path(output) / "scene.toml"
    file.write_text(settings + SCENE, encoding="utf-8")
    result = toile.dress(toile.load_scene(file), output=output, say=print)
    print(f"{result.status}: {result.garments[0].fabric.name}, {len(result.garments[0].faces)} triangles")
    return result


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
