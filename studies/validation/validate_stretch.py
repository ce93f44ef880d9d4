"""Stretch curves: a strip that is pulled has the tension of its fabric's curve, and contracts as it says."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf

import numpy as np

from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fabric_curves import curve_tables
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.cloth.stretch_curve import tension_at
from toile.engine.forces.step_request import StepRequest
from toile.studies.scenes.flat_meshes import KINDS, mesh
from toile.studies.scenes.motion import free_stepper
from toile.studies.validation.validation_row import ValidationRow, relative_row

LENGTH, WIDTH, EDGE = 0.2, 0.1, 0.025
"""Of the strip and its triangles [m]."""
CURVED = Fabric(
    name="curved", areal_density=0.1, thickness=2e-4, bending_warp=0.0, bending_weft=0.0, bending_bias=0.0,
    stretch_warp=1000.0, stretch_weft=600.0, shear=40.0, compression=0.1, poisson=0.6,
    stretch_curve_warp=((0.01, 8.0), (0.03, 40.0), (0.05, 150.0), (0.06, 300.0)),
    stretch_curve_weft=((0.02, 10.0), (0.05, 60.0), (0.08, 250.0)),
)  # fmt: skip
LOCKING = replace(
    CURVED, name="locking", stretch_curve_warp=(), stretch_curve_weft=(), poisson=0.0, strain_limit=0.05
)
STRAINS = (0.01, 0.03, 0.042, 0.055)
"""At points of the curves, between them, and beyond the limit."""
BAR = 2.0
"""Percent."""
PULL = StepRequest(
    h=1e4, at_rest=False, newton=60, newton_tolerance=1e-10, cg_tolerance=1e-8, cg_iterations=5000,
    motion_max=inf,
)  # fmt: skip
"""One step so long that inertia does not count."""


def contraction(fabric: Fabric, along: int) -> float:
    """Return how much a strip pulled along warp (0) or weft (1) contracts, per stretch."""
    first = [float(table[0, 3]) for table in curve_tables(fabric)]
    return fabric.poisson * float(np.sqrt(first[along] / first[1 - along]))


def pulled(fabric: Fabric, kind: str, along: int, strain: float) -> tuple[float, float]:
    """Return tension [N/m] and contraction of a strip pulled along warp (0) or weft (1), its sides free.

    The grips hold the ends along the pull; across it they let them contract.
    """
    points, faces = mesh(kind, LENGTH, WIDTH, EDGE)
    pattern = points if along == 0 else np.column_stack((-points[:, 1], points[:, 0]))
    start = np.column_stack((points * [1.0 + strain, 1.0], np.zeros(len(points))))
    left, right = points[:, 0] < 1e-9, points[:, 0] > LENGTH - 1e-9
    start[left | right, 1] *= 1.0 - contraction(fabric, along) * strain
    stepper = free_stepper(flat_cloth(pattern, faces, start, fabric, pinned=left | right), gravity=0.0)
    stepper.step(PULL)
    gradient = np.zeros_like(stepper.x)
    for force in stepper.forces:
        force.add_gradient(stepper.x, gradient)
    middle = np.abs(points[:, 0] - 0.5 * LENGTH) < 0.2 * LENGTH
    low, high = (stepper.x[middle & (np.abs(points[:, 1] - y) < 1e-9), 1].mean() for y in (0.0, WIDTH))
    return float(gradient[right, 0].sum() / WIDTH), 1.0 - float(high - low) / WIDTH


def validate_stretch() -> Iterator[ValidationRow]:
    """Pull strips of three meshes along both threads."""
    for fabric in (CURVED, LOCKING):
        for kind in KINDS:
            for along, thread in enumerate(("warp", "weft")):
                table, narrower = curve_tables(fabric)[along], contraction(fabric, along)
                for strain in STRAINS:
                    tension, found = pulled(fabric, kind, along, strain)
                    variant = f"{fabric.name}, {kind}, {thread}, {100 * strain:g} %"
                    expected = tension_at(table, strain)
                    yield relative_row("stretch", variant, "tension, N/m", tension, expected, BAR)
                    if narrower:
                        expected = narrower * strain
                        yield relative_row("stretch", variant, "contraction", found, expected, BAR)
