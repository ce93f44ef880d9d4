"""Recognition of a body file's unit and up axis from the size and shape of what it holds."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

METRES_PER_UNIT = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001}
"""Units that may be given."""

RECOGNISED_UNITS = ("m", "cm", "mm")
"""Units that are recognised from the size; a decimetre file must say so, for it could be a statue too."""

HUMAN_SIZE = (0.5, 2.6)
"""Largest extent of a standing, sitting or reaching human from toddler to giant [m]."""

PLAUSIBLE_SIZE = (0.3, 3.0)
"""Largest extent that is still taken for a body, doll or statue when no unit was given [m]."""

GIVEN_UNIT_SIZE = (0.05, 10.0)
"""Largest extent that is believed when the unit was given [m]."""


def upright(positions: npt.NDArray[np.floating], up: str) -> Float:
    """Turn positions of that up axis, shape (..., 3), so that Y is up; a Z-up body that faces -Y faces +Z."""
    turned = positions if up == "y" else positions[..., [0, 2, 1]] * (1.0, 1.0, -1.0)
    return np.ascontiguousarray(turned, np.float64)


@dataclass(frozen=True, kw_only=True)
class Frame:
    """Unit and axes of a file: metres per unit, the axis that points up, and what was recognised."""

    metres_per_unit: float
    up_axis: Literal["y", "z"]
    notes: tuple[str, ...]


def recognise_frame(
    file_name: str, vertices: Float, *, units: str | None, up: str | None, is_gltf: bool
) -> Frame:
    """Return unit and up axis of a body, as given or as its extents suggest.

    `vertices` are in file units, shape (v, 3). Raises InputError if no unit makes the body 0.3 to 3 m
    large, or if a given unit makes it absurd.
    """
    extents = np.ptp(vertices, axis=0)
    size = float(extents.max())
    if size <= 0.0:
        raise InputError(f"{file_name}: all vertices lie in one point; export the body again")
    notes: list[str] = []

    if units is None:
        units = _recognised_unit(file_name, size, is_gltf)
        source = (
            "the format's own unit" if is_gltf and units == "m" else f"recognised from its size of {size:.4g}"
        )
        notes.append(f"Units: {units} ({source}); the body is {size * METRES_PER_UNIT[units]:.2f} m large.")
    scale = METRES_PER_UNIT[units]
    if not GIVEN_UNIT_SIZE[0] <= size * scale <= GIVEN_UNIT_SIZE[1]:
        raise InputError(
            f"{file_name}: the avatar would be {size * scale:.4g} m large in {units}; give the correct units"
        )

    if up is None:
        axis: Literal["y", "z"] = "y" if is_gltf else _recognised_up(vertices)
        reason = "the format's own axes" if is_gltf else "recognised from its shape"
        notes.append(f"Up axis: {axis.upper()} ({reason}).")
    else:
        axis = "z" if up == "z" else "y"
    height = extents[1 if axis == "y" else 2]
    if height < 0.35 * size:
        notes.append(
            f"The body is only {height * scale:.2f} m tall along its up axis but {size * scale:.2f} m large: "
            "if it stands, give the other up axis."
        )
    return Frame(metres_per_unit=scale, up_axis=axis, notes=tuple(notes))


def _recognised_unit(file_name: str, size: float, is_gltf: bool) -> str:
    """Return the unit that makes a body `size` units large human; glTF is metres by its specification."""
    ranges = (HUMAN_SIZE, PLAUSIBLE_SIZE)
    if is_gltf and PLAUSIBLE_SIZE[0] <= size <= PLAUSIBLE_SIZE[1]:
        return "m"
    for low, high in ranges:
        for unit in RECOGNISED_UNITS:
            if low <= size * METRES_PER_UNIT[unit] <= high:
                return unit
    sizes = ", ".join(f"{size * METRES_PER_UNIT[unit]:.4g} m in {unit}" for unit in RECOGNISED_UNITS)
    raise InputError(
        f"{file_name}: the avatar is not the size of a body in any unit ({sizes}); "
        "give its units (m, dm, cm or mm) or scale the file"
    )


def _recognised_up(vertices: Float) -> Literal["y", "z"]:
    """Axis that points up.

    A body is taller than deep, standing or sitting, so the larger of the y and z extents is up. Where they
    are alike (a walker, a reclining or crouching body), the one that starts on the floor at zero is up;
    failing that, Y, the convention of OBJ and of this program.
    """
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    _, height_y, height_z = high - low
    if height_y > 1.25 * height_z:
        return "y"
    if height_z > 1.25 * height_y:
        return "z"
    on_floor_y = abs(low[1]) < 0.02 * height_y
    on_floor_z = abs(low[2]) < 0.02 * height_z
    return "z" if on_floor_z and not on_floor_y else "y"
