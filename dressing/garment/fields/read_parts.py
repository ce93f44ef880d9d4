"""Fields, elastic, holds and gas of a garment from the tables of a scene file."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.fields.closure import Closure
from toile.dressing.garment.fields.field import (
    OF_FABRIC,
    QUANTITIES,
    Elastic,
    Field,
    FieldValue,
    Filling,
    Hold,
    Painted,
    Parts,
    Textured,
)
from toile.dressing.garment.fields.layer import Layer
from toile.dressing.garment.fields.patch import Patch
from toile.engine.cloth.fields.keyed import Keyed
from toile.geometry.errors import InputError

Part = TypeVar("Part", Field, Elastic, Hold, Closure, Patch, Layer)
NUMBER = (int, float)
VALUE = (int, float, dict)
PART_KEYS: dict[str, dict[str, tuple[Any, str]]] = {
    "garment.field": {
        "panels": (list, "names of the panels (default: all, or those of the run)"),
        "run": (str, 'edges: a role such as waist, a label, or "front.3 + back.1[0:0.5]"'),
        "width": (NUMBER, "of the band beside the run that the field covers [m]"),
        "polygon": (list, "corners [x, y] in the panel's own coordinates [m] of what it covers"),
        "rest_warp": (VALUE, "length along the warp at rest over that in the pattern"),
        "rest_weft": (VALUE, "the same along the weft"),
        "pressure": (VALUE, "pressure towards the right side [Pa]"),
        "pull": (VALUE, "stiffness per area that draws a mesh garment to where it starts [N/m^3]"),
        **{name: (VALUE, f"see toile.Fabric.{name}, SI units") for name in OF_FABRIC},
    },
    "garment.elastic": {
        "run": (str, 'edges: a role such as waist, a label, or "front.3 + back.1[0:0.5]"'),
        "rest": (VALUE, "length of the elastic at rest over that of the edges in the pattern"),
        "stiffness": (VALUE, "its tension per strain [N]"),
    },
    "garment.hold": {
        "run": (str, "edges that a film holds where they are at its start; or"),
        "panels": (list, "names of panels that it holds"),
        "frames": (list, "first frame in which they are held and first in which they are free: [0, 10]"),
        "share": (dict, "instead: { times = [0, 1], values = [1, 0] }, how much of the stiffness acts"),
        "stiffness": (NUMBER, "per area [N/m^3], default 1e6; soft pins have less"),
        "follow": (bool, "whether the places go along with the body (default), or stay in the room"),
    },
    "garment.closure": {
        "kind": (str, "buttons, snaps (hooks alike) or zip"),
        "over": (str, "edges of one panel, walked along its loop, such as left.1 or a label"),
        "under": (str, "edges of the other side, walked against the loop"),
        "count": (int, "how many buttons or snaps"),
        "inset": (NUMBER, "how far inside of the edges they are [m], default 0"),
        "ends": (NUMBER, "distance of the first and last from the ends of the edges [m]"),
        "wrong_side": (bool, "true: over lies on the wrong side of under"),
        "closed": (VALUE, "share of the row that is closed, from where it begins, default 1"),
        "distance": (NUMBER, "how far apart the two sides are when closed [m], default 0.003"),
        "stiffness": (NUMBER, "of each pair [N/m], default 3000; of a zip per length [N/m^2], default 3e5"),
        "most": (NUMBER, "largest force of each pair [N], 60 or 15; of a zip per length [N/m], 6000"),
    },
    "garment.patch": {
        "run": (str, 'edges of it that are sewn on, in a row: "pocket.3 + pocket.0 + pocket.1"'),
        "onto": (str, "name of the panel on whose right side it lies"),
        "at": (list, "where its own origin lies in the coordinates of that panel, [x, y] [m]"),
        "turn": (NUMBER, "by how much it is turned there, counter-clockwise [degrees]"),
    },
    "garment.layer": {
        "fabric": (str, "name of the fabric of the layer (default: that of the cloth itself, as of a hem)"),
        "bond": (NUMBER, "0 slides along the cloth (default), 1 is one plate with it; glue is between"),
        "panels": (list, "names of the panels (default: all, or those of the run)"),
        "run": (str, 'edges: a role such as waist, a label, or "front.3 + back.1[0:0.5]"'),
        "width": (NUMBER, "of the band beside the run that the layer covers [m]"),
        "polygon": (list, "corners [x, y] in the panel's own coordinates [m] of what it covers"),
    },
    "garment.gas": {
        "pressure": (VALUE, "constant pressure above that outside of a closed garment [Pa]; or"),
        "volume": (VALUE, "volume that the gas in it has outside [m^3]"),
    },
}
"""Table name to key to (accepted types, meaning)."""
PART_HEADINGS = {name: f"[[{name}]]" for name in ("garment", *PART_KEYS) if name != "garment.gas"}
GARMENT_KEYS: dict[str, tuple[Any, str]] = {
    "field": (list, "tables: one [[garment.field]] for each part with values of its own"),
    "elastic": (list, "tables: one [[garment.elastic]] for each elastic along edges"),
    "hold": (list, "tables: one [[garment.hold]] for what a film holds for a time"),
    "closure": (list, "tables: one [[garment.closure]] for each row of buttons or snaps, or zip"),
    "patch": (list, "tables: one [[garment.patch]] for each panel sewn onto another, such as a pocket"),
    "layer": (list, "tables: one [[garment.layer]] for each lining, interlining, facing or hem"),
    "gas": (dict, "table: gas in a closed garment"),
}
"""The keys of [[garment]] under which they stand."""
VALUE_KEYS: dict[str, Any] = {
    "times": list, "values": list, "attribute": str, "image": str, "low": NUMBER, "high": NUMBER, "box": list,
}  # fmt: skip
"""Keys of a value that is a table: keyed over a film, painted on vertices, or from an image."""


def read_parts(values: Mapping[str, Any], folder: Path) -> Parts:
    """Return the parts of a [[garment]] table whose keys are checked; images are relative to a folder.

    Raises InputError naming the key.
    """
    gas = values.get("gas")
    parts = Parts(
        fields=tuple(_each(values, "field", lambda table: _field(table, folder))),
        elastic=tuple(_each(values, "elastic", lambda table: _elastic(table, folder))),
        holds=tuple(_each(values, "hold", lambda table: _hold(table, folder))),
        closures=tuple(_each(values, "closure", lambda table: _closure(table, folder))),
        patches=tuple(_each(values, "patch", lambda table: _patch(table, folder))),
        layers=tuple(_each(values, "layer", lambda table: _layer(table, folder))),
    )
    if gas is None:
        return parts
    with _within("gas"):
        return replace(parts, gas=Filling(**_checked(gas, "garment.gas", (), folder)))


def _each(values: Mapping[str, Any], name: str, read: Callable[[Any], Part]) -> Iterator[Part]:
    """Yield what is read from each table of a list."""
    for index, table in enumerate(_tables(values, name)):
        with _within(name, index):
            yield read(table)


@contextmanager
def _within(*place: str | int) -> Iterator[None]:
    """Let errors raised inside name their key by its whole path."""
    try:
        yield
    except InputError as error:
        path = (*place, *([error.field] if error.field else []))
        raise InputError(str(error), file=error.file, field=".".join(map(str, path))) from None


def _tables(values: Mapping[str, Any], name: str) -> list[Any]:
    tables = values.get(name, [])
    if not all(isinstance(table, dict) for table in tables):
        raise InputError(f"{name} is a list of tables: write [[garment.{name}]]", field=name)
    return list(tables)


def _checked(table: Any, name: str, needed: tuple[str, ...], folder: Path) -> dict[str, Any]:
    """Return the values of a table. Raises InputError for unknown keys, wrong types and missing keys."""
    short, known = name.removeprefix("garment."), PART_KEYS[name]
    found: dict[str, Any] = {}
    for key, value in table.items():
        if key not in known:
            raise InputError(f"{short}: {unknown_name('key', key, known)}", field=key)
        kinds = known[key][0] if isinstance(known[key][0], tuple) else (known[key][0],)
        if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
            raise InputError(f"{short}: {key} cannot be {value!r}; see toile dress --scene-keys", field=key)
        found[key] = _value(key, value, folder) if isinstance(value, dict) else value
    for key in needed:
        if key not in found:
            raise InputError(f"{short}: lacks {key}; see toile dress --scene-keys", field=short)
    return found


def _field(table: Any, folder: Path) -> Field:
    found = _checked(table, "garment.field", (), folder)
    return Field(
        values={name: found[name] for name in QUANTITIES if name in found},
        panels=_names(found.get("panels", []), "field"),
        run=found.get("run"), width=found.get("width"),
        polygon=_corners(found),
    )  # fmt: skip


def _layer(table: Any, folder: Path) -> Layer:
    found = _checked(table, "garment.layer", (), folder)
    return Layer(**{**found, "panels": _names(found.get("panels", []), "layer"), "polygon": _corners(found)})


def _corners(found: Mapping[str, Any]) -> tuple[Any, ...]:
    """Return the corners of a polygon, to be checked."""
    given = found.get("polygon", [])
    return tuple(tuple(corner) if isinstance(corner, list) else (corner,) for corner in given)


def _elastic(table: Any, folder: Path) -> Elastic:
    return Elastic(**_checked(table, "garment.elastic", ("run", "rest", "stiffness"), folder))


def _closure(table: Any, folder: Path) -> Closure:
    return Closure(**_checked(table, "garment.closure", ("kind", "over", "under"), folder))


def _patch(table: Any, folder: Path) -> Patch:
    found = _checked(table, "garment.patch", ("run", "onto", "at"), folder)
    return Patch(**{**found, "at": tuple(found["at"])})


def _hold(table: Any, folder: Path) -> Hold:
    found = _checked(table, "garment.hold", (), folder)
    if "frames" in found:
        found["frames"] = tuple(found["frames"])
    return Hold(**{**found, "panels": _names(found.get("panels", []), "hold")})


def _names(names: list[Any], where: str) -> tuple[str, ...]:
    if not all(isinstance(name, str) for name in names):
        raise InputError(f"{where}: panels lists names of panels, got {names!r}", field="panels")
    return tuple(names)


def _value(name: str, table: Mapping[str, Any], folder: Path) -> FieldValue:
    """Return a value that is a table."""
    for key, value in table.items():
        if key not in VALUE_KEYS:
            raise InputError(f"{name}: {unknown_name('key', key, VALUE_KEYS)}", field=name)
        if not isinstance(value, VALUE_KEYS[key]) or isinstance(value, bool):
            raise InputError(f"{name}: {key} cannot be {value!r}", field=name)
    low, high = float(table.get("low", 0.0)), float(table.get("high", 1.0))
    if "attribute" in table:
        return Painted(table["attribute"], low, high)
    if "image" in table:
        texture = Textured(folder / table["image"], low, high)
        box = table.get("box")
        if box is None:
            return texture
        if (
            len(box) != 4
            or not all(isinstance(n, NUMBER) for n in box)
            or box[0] >= box[2]
            or box[1] >= box[3]
        ):
            raise InputError(f"{name}: box is left, lower, right, upper [m], got {box!r}", field=name)
        left, lower, right, upper = (float(number) for number in box)
        return replace(texture, box=(left, lower, right, upper))
    if "times" not in table or "values" not in table:
        raise InputError(
            f"{name}: a table has times and values, an attribute, or an image; got {sorted(table)}",
            field=name,
        )
    return Keyed(tuple(table["times"]), tuple(table["values"]))
