"""Values that users give for fields of a scene, in any convenient spelling, as the scene holds them."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from toile.dressing.garment.fabrics import checked_fabric
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.pattern.pattern import Pattern
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, is_whole, real, shown, truth
from toile.remesh.sizing.sizing import SizingOptions


def given_path(value: object, field: str) -> Path:
    """Return a path, given as one or as a text. Raises InputError for anything else."""
    if not isinstance(value, str | Path):
        raise InputError(f"{field} must be a path, got {shown(value)}", field=field)
    return Path(value)


def given_names(value: object, field: str) -> tuple[str, ...]:
    """Return names, given as a sequence or as one name. Raises InputError for anything else."""
    names = (value,) if isinstance(value, str) else value
    if not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
        raise InputError(f"{field} must be a list of texts, got {shown(value)}", field=field)
    return tuple(names)


def checked_text(value: object, field: str) -> None:
    """Raise InputError unless a value is a text or None."""
    if not isinstance(value, str | None):
        raise InputError(f"{field} must be a text, got {shown(value)}", field=field)


def given_real(value: object, field: str, *, words: bool = False) -> float | str | None:
    """Return a number as a float, None as it is, and a text where `words` are allowed.

    Numbers that are not finite stay for those who know the limits. Raises InputError for anything else.
    """
    if value is None or (words and isinstance(value, str)):
        return value
    if is_real(value):
        return float(value)  # type: ignore[arg-type]
    if isinstance(value, float | np.floating):
        return float(value)
    raise InputError(f"{field} must be a number, got {shown(value)}", field=field)


def given_garment(source: object) -> str | Path | GarmentMesh | Pattern:
    """Return what a garment is made from; a GarmentCode specification as a dictionary becomes its Pattern.

    Raises InputError if nothing can be made from it.
    """
    if isinstance(source, Mapping):
        from toile.dressing.pattern.garmentcode import pattern_of

        return pattern_of(source)
    if not isinstance(source, str | Path | GarmentMesh | Pattern):
        raise InputError(
            "a garment is the name of a pattern, a file, a Pattern, a GarmentCode specification as a "
            f"dictionary or a GarmentMesh, got {shown(source)}",
            field="source",
        )
    return source


def given_pins(value: object) -> tuple[str | int, ...]:
    """Return pins, given as one or as a sequence, numbers as int. Raises InputError for anything else."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    pins = (value,) if isinstance(value, str) or is_whole(value) else value
    if not isinstance(pins, Sequence) or not all(isinstance(pin, str) or is_whole(pin) for pin in pins):
        raise InputError(f"pins are edge labels and numbers of vertices, got {shown(value)}", field="pins")
    return tuple(pin if isinstance(pin, str) else int(pin) for pin in pins)


def given_warp(value: object) -> float | dict[str, float]:
    """Return the turn of the warp [degrees], or those of panels. Raises InputError unless it is finite."""
    angles = value.values() if isinstance(value, Mapping) else (value,)
    for angle in angles:
        if not is_real(angle):
            raise InputError(
                f"warp_angle must be a finite number of degrees, or one for each panel, got {shown(angle)}",
                field="warp_angle",
            )
    if isinstance(value, Mapping):
        return {str(panel): float(angle) for panel, angle in value.items()}
    return float(value)  # type: ignore[arg-type]


def check_fabric(fabric: object, field: str) -> None:
    """Raise InputError unless a fabric is a name, a Fabric of plausible numbers, or None."""
    if isinstance(fabric, Fabric):
        checked_fabric(fabric)
    elif not isinstance(fabric, str | None):
        raise InputError(
            f"{field} must be the name of a fabric or a Fabric, got {shown(fabric)}", field=field
        )


def check_fabrics(fabrics: object) -> None:
    """Raise InputError unless fabrics are Fabrics by their names."""
    if not isinstance(fabrics, Mapping):
        raise InputError(f"fabrics must be Fabrics by their names, got {shown(fabrics)}", field="fabrics")
    for name, fabric in fabrics.items():
        if not isinstance(fabric, Fabric):
            raise InputError(f"fabrics: '{name}' must be a Fabric, got {shown(fabric)}", field="fabrics")
        checked_fabric(fabric)


def given_remesh(value: object) -> bool | SizingOptions:
    """Return whether a mesh adapts, or how. Raises InputError unless it says so."""
    if isinstance(value, SizingOptions):
        return value
    if is_real(value) or isinstance(value, str):
        raise InputError(f"remesh must be True, False or SizingOptions, got {shown(value)}", field="remesh")
    return truth(value, "remesh")


def given_ground(value: object) -> bool | float:
    """Return whether there is a floor, or its height [m]. Raises InputError unless it says so."""
    if is_real(value):
        return real(value, "ground", -1000.0, 1000.0, "m")
    return truth(value, "ground")


def given_friction(pairs: object) -> dict[tuple[str, str], float]:
    """Return friction of pairs. Raises InputError naming what is none."""
    if not isinstance(pairs, Mapping):
        raise InputError(
            f"friction_between must be numbers by pairs of names, got {shown(pairs)}",
            field="friction_between",
        )
    found = {}
    for pair, value in pairs.items():
        if not isinstance(pair, tuple) or len(pair) != 2:
            raise InputError(f"friction_between: a pair is two names, got {pair!r}", field="friction_between")
        what = f"friction_between {' and '.join(map(str, pair))}"
        found[pair] = real(value, what, 0.0, 10.0, field="friction_between")
    return found
