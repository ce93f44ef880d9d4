"""The Cusick drape test (BS 5058): a round cloth, held level between two discs, hangs over their rim.

Its drape coefficient is the share of the free ring that its shadow still covers: 0 hangs straight down, 1
stays level.
"""

from dataclasses import replace

import numpy as np
from scipy.spatial import Delaunay

from toile.dressing.pictures.rasterizer import rasterize
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.drape.drape import Drape
from toile.engine.drape.plan import DrapePlan, DrapeRecord
from toile.geometry.arrays import Float, Int
from toile.studies.scenes.scenes import film_plan, sheet

DISC, SPECIMEN = 0.09, 0.15
"""Radii of the discs and of the cloth [m]."""
PIXEL = 2.5e-4
"""Of the shadow [m]."""
MAX_STEPS = 600
CALM = 2e-5
"""Motion over a frame of steps at which the cloth hangs, root mean square [m]."""


def ring_mesh(edge: float) -> tuple[Float, Int]:
    """Return points [m], shape (n, 2), and faces, shape (t, 3), of the free ring and one held row within it.

    Rows of nodes are shifted by random angles, the numbers in them grow with the radius: it is irregular.
    """
    generator = np.random.default_rng(1)
    rows = max(2, round((SPECIMEN - DISC) / (np.sqrt(0.75) * edge)))
    height = (SPECIMEN - DISC) / rows
    points = []
    for radius in np.linspace(DISC - height, SPECIMEN, rows + 2):
        count = round(2.0 * np.pi * radius / edge)
        angle = 2.0 * np.pi * (np.arange(count) + generator.uniform()) / count
        points.append(radius * np.column_stack((np.cos(angle), np.sin(angle))))
    flat = np.concatenate(points)
    faces = Delaunay(flat).simplices.astype(np.int32)
    inner = len(points[0])
    faces = faces[(faces >= inner).any(axis=1)]
    a, b, c = (flat[faces[:, k]] for k in range(3))
    turned = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    faces[turned] = faces[turned][:, [0, 2, 1]]
    return flat, np.ascontiguousarray(faces)


def specimen(material: Fabric, edge: float) -> Cloth:
    """Return the round cloth, level; what lies between the discs is pinned and left out but for one row."""
    flat, faces = ring_mesh(edge)
    positions = np.column_stack((flat[:, 0], np.zeros(len(flat)), -flat[:, 1]))
    held = np.linalg.norm(flat, axis=1) < DISC + 1e-9
    return sheet(flat, faces, positions, held, material)


def hung(material: Fabric, edge: float, max_steps: int = MAX_STEPS) -> tuple[Cloth, DrapeRecord]:
    """Let the cloth hang to rest; return it and what that took."""
    plan = DrapePlan(
        step=film_plan().step,
        max_steps=max_steps,
        rms_motion=CALM,
        peak_motion=10.0 * CALM,
        cg_tolerance=1e-3,
    )
    run = Drape(specimen(material, edge), None, [], plan, lambda _: True)
    record = run.hang()
    return run.cloth, record


def drape_coefficient(cloth: Cloth) -> float:
    """Return the drape coefficient of a cloth that hangs: its shadow from above, counted in pixels."""
    size = 2 * round(1.1 * SPECIMEN / PIXEL)
    x = cloth.positions
    centre = 0.5 * (size - 1)
    screen = np.column_stack((x[:, 0] / PIXEL + centre, x[:, 2] / PIXEL + centre, x[:, 1]))
    _, face_at = rasterize(screen, cloth.face_nodes, size, size, far=-1e9)
    across = (np.arange(size) - centre) * PIXEL
    disc = across[:, None] ** 2 + across**2 < DISC**2
    shadow = PIXEL**2 * float(np.count_nonzero((face_at >= 0) & ~disc))
    return shadow / (np.pi * (SPECIMEN**2 - DISC**2))


def stiffer(material: Fabric, factor: float) -> Fabric:
    """Return a fabric whose membrane is so many times stiffer."""
    return replace(
        material, stretch_warp=factor * material.stretch_warp, stretch_weft=factor * material.stretch_weft,
        shear=factor * material.shear,
    )  # fmt: skip


def tauter(material: Fabric, factor: float) -> Fabric:
    """Return a fabric so many times stiffer in tension, no stiffer in compression and shear."""
    return replace(
        material, stretch_warp=factor * material.stretch_warp, stretch_weft=factor * material.stretch_weft,
        compression=material.compression / factor,
    )  # fmt: skip


def bent(material: Fabric, factor: float) -> Fabric:
    """Return a fabric whose bending is so many times stiffer."""
    return replace(
        material, bending_warp=factor * material.bending_warp, bending_weft=factor * material.bending_weft,
        bending_bias=factor * material.bending_bias,
    )  # fmt: skip
