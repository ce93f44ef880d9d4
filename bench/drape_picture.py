"""Draw the drape test of some fabrics.

python bench/drape_picture.py docs/images/validate_drape.png
"""

import sys
from pathlib import Path

import numpy as np
import trimesh

from toile.dressing.files.palette import BODY, garment_colour
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.files.writers.png import png_bytes
from toile.dressing.garment.fabrics import fabric
from toile.dressing.pictures.preview import PreviewMesh, render_front
from toile.studies.validation.cusick import DISC, drape_coefficient, hung
from toile.studies.validation.validate_drape import EDGE

NAMES = ("silk-charmeuse", "wool-worsted", "wool-coating")
APART, HEIGHT, THICK = 0.34, 0.12, 0.003
"""Distance of the stands, their height, and how thick their discs are [m]."""


def main(path: Path) -> None:
    meshes = []
    for index, name in enumerate(NAMES):
        cloth, _ = hung(fabric(name), EDGE)
        print(f"{name}: DC {100.0 * drape_coefficient(cloth):.1f} %")
        shift = np.array([(index - 0.5 * (len(NAMES) - 1)) * APART, HEIGHT, 0.0])
        colour = garment_colour(index)
        meshes.append(PreviewMesh(cloth.positions + shift, cloth.face_nodes, colour, double_sided=True))
        for radius, low, high in ((DISC, THICK, THICK), (DISC, -THICK, THICK), (0.03, -HEIGHT, HEIGHT)):
            part = trimesh.creation.cylinder(radius=radius - 5e-4, height=high, sections=96)
            upright = np.asarray(part.vertices)[:, [0, 2, 1]] * (1.0, 1.0, -1.0)
            centre = shift + np.array([0.0, 0.5 * low, 0.0])
            meshes.append(PreviewMesh(upright + centre, np.asarray(part.faces), BODY))
    # Pictures are upright; what is above and below the row of stands is empty.
    pixels = render_front(meshes, 1200)[0]
    write_atomic(path, png_bytes(np.ascontiguousarray(pixels[480:720])))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
