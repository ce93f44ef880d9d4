"""The curves of tension of a fabric, as tables; without kernels: fabrics are checked without numba."""

from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.stretch_curve import limited, straight, through
from toile.geometry.arrays import Float


def curve_tables(fabric: Fabric) -> tuple[Float, Float]:
    """Return the tables of tension over strain along warp and weft of a fabric: see `stretch_curve`."""
    tables = []
    for stiffness, points in (
        (fabric.stretch_warp, fabric.stretch_curve_warp), (fabric.stretch_weft, fabric.stretch_curve_weft),
    ):  # fmt: skip
        if points:
            tables.append(through(points))
        else:
            # With Poisson's ratio the stiffness is that of cloth kept from contracting, as tables of fabrics
            # have it; the curve is that of cloth free to do so.
            free = stiffness * (1.0 - fabric.poisson**2)
            tables.append(limited(free, fabric.strain_limit) if fabric.strain_limit else straight(free))
    return tables[0], tables[1]


def has_law(fabric: Fabric) -> bool:
    """Tell whether a fabric stretches otherwise than in proportion, thread by thread."""
    curved = fabric.stretch_curve_warp or fabric.stretch_curve_weft
    return bool(curved) or fabric.strain_limit > 0.0 or fabric.poisson > 0.0
