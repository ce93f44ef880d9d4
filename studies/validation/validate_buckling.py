"""Lateral buckling: a narrow strip held on edge at one end falls sideways at a known weight.

The weight counts as Gamma = weight per area L^3 / D. Prandtl's cantilever under its own weight q per length
buckles at q L^3 = 12.854 sqrt(E I G J); with E I = D (1 - nu^2) b and G J = 2 D (1 - nu) b of a strip of
width b that is Gamma = 12.854 (1 - nu) sqrt(2 (1 + nu)), for b much smaller than L.
"""

from collections.abc import Iterator

import numpy as np
from scipy.linalg import eigh

from toile.engine.forces.membrane import Membrane
from toile.geometry.arrays import Float
from toile.studies.scenes.flat_meshes import KINDS
from toile.studies.validation.heavy_strip import ElasticStrip, clamped_strip
from toile.studies.validation.validation_row import ValidationRow, relative_row

WIDTH, EDGES_PER_WIDTH = 0.02, 3
"""Of a strip of length 1: what the clamp adds is in proportion to the width (1.3 % here, 3 % at 0.05)."""
STIFFNESS = 1e8
"""Of the membrane, times L^2 / D: the strip must not sag in its plane."""
POISSON = (0.0, 0.3)
BAR = 3.0


def critical_weight(poisson: float) -> float:
    """Return Gamma at which theory has a narrow strip buckle."""
    return 12.854 * (1.0 - poisson) * float(np.sqrt(2.0 * (1.0 + poisson)))


def buckling_weight(kind: str, poisson: float, width: float = WIDTH, edges: int = EDGES_PER_WIDTH) -> float:
    """Return Gamma at which the stiffness against sideways motion of a strip on edge becomes singular.

    The strip finds its equilibrium in its plane under the weight of the theory, which hardly bends it there;
    stresses grow with the weight, and so does what they take from the bending stiffness.
    """
    strip = clamped_strip(kind, width, width / edges)
    elastic = ElasticStrip(strip, STIFFNESS, poisson)
    start: Float = np.column_stack((strip.points, np.zeros(len(strip.points))))
    weight = critical_weight(poisson)
    # Nothing draws it out of the plane that it starts in, unstable though it is there.
    settled = elastic.settled(start, weight, strip.held)
    stressed = sideways_stiffness(elastic, settled) / weight
    free = np.flatnonzero(~strip.held)
    bending = elastic.bending.stiffness.toarray()[np.ix_(free, free)]
    # K + Gamma S is singular at the largest 1 / Gamma with -S z = K z / Gamma.
    last = len(free) - 1
    largest = eigh(-stressed[np.ix_(free, free)], bending, eigvals_only=True, subset_by_index=(last, last))
    return 1.0 / float(largest[0])


def sideways_stiffness(elastic: ElasticStrip, x: Float) -> Float:
    """Return the membrane's stiffness against motion along z at z = 0, shape (n, n).

    By differences of its gradient along z, which is odd in z; stresses count whether they pull or push.
    """
    faces, stiffness = elastic.strip.faces, elastic.stiffness
    size = 1e-7 * float(np.ptp(x[faces[0]], axis=0).max())
    result = np.zeros((len(x), len(x)))
    # Faces apart: each corner is moved in all of them at once.
    apart = np.arange(faces.size, dtype=np.int32).reshape(-1, 3)
    own = np.ascontiguousarray(x[faces].reshape(-1, 3))
    rest = np.ascontiguousarray(elastic.strip.points[faces])
    membrane = Membrane(apart, rest, stiffness, stiffness, 0.5 * stiffness)
    for corner in range(3):
        moved = own.copy()
        moved[apart[:, corner], 2] += size
        membrane.evaluate(moved)
        for other in range(3):
            forces = membrane.element_gradient[:, other, 2] / size
            np.add.at(result, (faces[:, other], faces[:, corner]), forces)
    # Rounding must not make rigid motions cost anything: `eigh` would read one half of the matrix only.
    return 0.5 * (result + result.T)


def validate_buckling() -> Iterator[ValidationRow]:
    """Find the critical weight of strips of three kinds of mesh, with and without Poisson's ratio."""
    for kind in KINDS:
        for poisson in POISSON:
            yield relative_row(
                "buckling", f"{kind}, nu {poisson:g}", "critical Gamma", buckling_weight(kind, poisson),
                critical_weight(poisson), BAR,
            )  # fmt: skip
