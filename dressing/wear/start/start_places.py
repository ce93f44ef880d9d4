"""Where the panels of garments start: lifted, hung, rolled, and clear of the body and of each other.

How far panels are lifted, moved and looked around is a matter of lengths that suit a grown person. A much
smaller body, a baby or a doll, is enlarged to that size with its garments, and where they start is made
smaller again.
"""

from dataclasses import replace

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

HEIGHT, CHEST = 1.7, 0.9
"""What the lengths of the start suit [m]."""
SMALL = 0.65
"""Size below which a body is enlarged, relative to that: a child of four years or less, or a doll."""


def start_places(
    meshes: list[GarmentMesh], avatar: tuple[Float, Int], around: tuple[Float, Int],
    body: Measurements | None, arm_angle: float,
) -> tuple[list[GarmentMesh], list[str]]:  # fmt: skip
    """Return garments where sewing begins, and one sentence for everything that was moved.

    `avatar` is the body with what it wears, vertices (v, 3) [m] and faces; its arms hang `arm_angle` below
    level [rad]. `around` is the same among obstacles, of which panels are cleared as well.
    Panels start flat where they cannot be cleared rolled; raises InputError if they cannot be cleared at all.
    """
    size = size_of(body)
    surface, person = _over(avatar, size), None if body is None else _person(body, size)
    shoulder = float("-inf") if person is None else float(person.shoulder_point[1])
    flat, rolled, flat_said, rolled_said = [], [], [], []
    for mesh in meshes:
        lifted, said = lift_over_shoulders(_enlarged(mesh, size), surface, shoulder, size)
        hung, more = hung_below(lifted, shoulder, size)
        layered, last = flared_outside(hung, size)
        flat.append(_put_back(mesh, layered, size))
        flat_said += [*said, *more, *last]
        ringed, said = rolled_rings(layered, surface, shoulder, size)
        tubed, more = rolled_sleeves(ringed, surface, person, arm_angle)
        rolled.append(_put_back(mesh, tubed, size))
        rolled_said += [*said, *more]
    try:
        cleared, notes = _cleared(rolled, around, size)
        return cleared, [*flat_said, *rolled_said, *notes]
    except InputError:
        cleared, notes = _cleared(flat, around, size)
        return cleared, [*flat_said, *notes]


def size_of(body: Measurements | None) -> float:
    """Return the size of a small body relative to a grown person, and 1 for all others.

    Height and chest both have to be small: half a dress form is short, and not small.
    """
    size = 1.0 if body is None else max(body.height / HEIGHT, body.chest / CHEST)
    return size if size < SMALL else 1.0


def _cleared(
    meshes: list[GarmentMesh], avatar: tuple[Float, Int], size: float
) -> tuple[list[GarmentMesh], list[str]]:
    """Return garments with layers laid on each other, whose panels cut nothing; raises InputError."""
    laid, said = laid_on(meshes, avatar[0])
    cleared, more = clear_panels([_enlarged(mesh, size) for mesh in laid], _over(avatar, size), size)
    return [_put_back(*pair, size) for pair in zip(laid, cleared, strict=True)], [*said, *more]


def _over(surface: tuple[Float, Int], size: float) -> tuple[Float, Int]:
    """Return a surface, vertices (v, 3) and faces, in units of `size` metres."""
    return surface if size == 1.0 else (surface[0] / size, surface[1])


def _person(body: Measurements, size: float) -> Measurements:
    """Return a body with its shoulder point in units of `size` metres: all that the start asks of it."""
    x, y, z = body.shoulder_point
    return replace(body, shoulder_point=(x / size, y / size, z / size))


def _enlarged(mesh: GarmentMesh, size: float) -> GarmentMesh:
    """Return a garment with its places in units of `size` metres."""
    if size == 1.0:
        return mesh
    return replace(mesh, positions=mesh.positions / size, uv=mesh.uv / size)


def _put_back(mesh: GarmentMesh, placed: GarmentMesh, size: float) -> GarmentMesh:
    """Return a garment in the places of the same one, enlarged [m]."""
    return placed if size == 1.0 else replace(mesh, positions=placed.positions * size)
