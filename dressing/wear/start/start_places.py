"""Where the panels of garments start: lifted, hung, rolled, and clear of the body and of each other."""

from toile.dressing.body.measurements import Measurements
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.wear.lay_on import laid_on
from toile.dressing.wear.layer_order import flared_outside
from toile.dressing.wear.start.hung_below import hung_below
from toile.dressing.wear.start.rings import rolled_rings
from toile.dressing.wear.start.sleeve_tubes import rolled_sleeves
from toile.dressing.wear.start_repair import clear_panels, lift_over_shoulders
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError


def start_places(
    meshes: list[GarmentMesh], avatar: tuple[Float, Int], around: tuple[Float, Int],
    body: Measurements | None, arm_angle: float,
) -> tuple[list[GarmentMesh], list[str]]:  # fmt: skip
    """Return garments where sewing begins, and one sentence for everything that was moved.

    `avatar` is the body with what it wears, vertices (v, 3) [m] and faces; its arms hang `arm_angle` below
    level [rad]. `around` is the same among obstacles, of which panels are cleared as well.
    Panels start flat where they cannot be cleared rolled; raises InputError if they cannot be cleared at all.
    """
    shoulder = float("-inf") if body is None else float(body.shoulder_point[1])
    flat, rolled, flat_said, rolled_said = [], [], [], []
    for mesh in meshes:
        lifted, said = lift_over_shoulders(mesh, avatar, shoulder)
        hung, more = hung_below(lifted, shoulder)
        layered, last = flared_outside(hung)
        flat.append(layered)
        flat_said += [*said, *more, *last]
        ringed, said = rolled_rings(layered, avatar, shoulder)
        tubed, more = rolled_sleeves(ringed, avatar, body, arm_angle)
        rolled.append(tubed)
        rolled_said += [*said, *more]
    try:
        cleared, notes = _cleared(rolled, around)
        return cleared, [*flat_said, *rolled_said, *notes]
    except InputError:
        cleared, notes = _cleared(flat, around)
        return cleared, [*flat_said, *notes]


def _cleared(meshes: list[GarmentMesh], avatar: tuple[Float, Int]) -> tuple[list[GarmentMesh], list[str]]:
    """Return garments with layers laid on each other, whose panels cut nothing; raises InputError."""
    laid, said = laid_on(meshes, avatar[0])
    cleared, more = clear_panels(laid, avatar)
    return cleared, [*said, *more]
