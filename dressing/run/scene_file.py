"""Reads a scene from a TOML file. `SCENE_KEYS` is both the schema and the documentation.

A complete example::

    quality = "standard"

    [avatar]
    file = "body.obj"

    [[garment]]
    source = "trousers"
    fabric = "my denim"

    [fabric."my denim"]
    like = "denim-12oz"
    areal_density = 0.42

Paths are relative to the scene file.
"""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, fields, replace
from pathlib import Path
from typing import Any

from toile.dressing.body.given_measurements import measurements_of
from toile.dressing.body.obstacles.obstacle import Obstacle
from toile.dressing.body.obstacles.obstacle_table import OBSTACLE_HEADING, OBSTACLE_KEYS, obstacle_of
from toile.dressing.body.posing.posed_body import moved_poses
from toile.dressing.files.parse_text import parse_toml
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.files.toml_lines import LineNumbers, OneLine, key_path
from toile.dressing.garment.fabric_keys import FABRIC_KEYS, SUPPLIERS, supplied_values
from toile.dressing.garment.fabrics import checked_fabric, fabrics
from toile.dressing.garment.fields.read_parts import GARMENT_KEYS, PART_HEADINGS, PART_KEYS, read_parts
from toile.dressing.pattern.fold_table import folds_of
from toile.dressing.run.air import AIR_KEYS, Air, air_of
from toile.dressing.run.garment_source import default_name
from toile.dressing.run.quality import quality_preset
from toile.dressing.run.scene import AvatarFile, Garment, MannequinSize, Scene
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError, about
from toile.remesh.sizing.sizing import SizingOptions

NUMBER = (int, float)
SCENE_KEYS: dict[str, dict[str, tuple[Any, str]]] = {
    "": {
        "quality": (str, "preview, standard (default) or accurate"),
        "edge_length": (NUMBER, "edge length of the triangles [m] instead of the quality's"),
        "remesh": ((bool, dict), "false: keep the mesh as it is; table: how it adapts to the folds"),
        "max_frames": (int, "frames after which the drape stops, instead of the quality's"),
        "gravity": (NUMBER, "downward acceleration [m/s^2], default 9.81"),
        "ground": (
            (bool, int, float),
            "false: no floor under the feet of a body that stands; a number: height of the floor [m]",
        ),
        "friction": (NUMBER, "friction against the body for all garments instead of the fabrics' own"),
        "friction_between": (list, 'friction of pairs: [["denim-12oz", "body", 0.5], ...]'),
        "air": (dict, "table: still air or wind on garments that follow a moving body"),
        "formats": (list, "formats in addition to PLY and OBJ: vtu, vtk, xdmf, msh, inp; of films: glb, mdd"),
        "fit": (str, "maps: write how garments fit; checked: with error bars, by a second mesh"),
        "certificate": (bool, "true: write certificate.json, which toile verify checks"),
        "threads": (int, "threads that share the work; the result is the same with any number"),
        "default_fabric": (str, "fabric of garments that name none, default cotton-poplin"),
        "avatar": (dict, "table: the body (default: the built-in mannequin)"),
        "garment": (list, "tables: one [[garment]] each, from the body outwards"),
        "obstacle": (list, "tables: one [[obstacle]] for each solid beside the body"),
        "fabric": (dict, "tables: one [fabric.NAME] for each fabric of your own"),
    },
    "remesh": {
        "size_min": (NUMBER, "shortest edges [m]"),
        "size_max": (NUMBER, "longest edges [m]"),
        "refine_angle": (NUMBER, "turn of the surface per edge [rad]"),
        "refine_velocity": (NUMBER, "change of velocity along an edge [m/s]"),
        "refine_compression": (NUMBER, "edge length over the inverse root of compression [m]"),
        "aspect_min": (NUMBER, "shortest over longest wanted edge of a triangle"),
    },
    "air": AIR_KEYS,
    "avatar": {
        "file": (str, "OBJ PLY STL GLB VRM USD VTU VTK XDMF INP MSH; one that moves: .npz .glb .usd, folder"),
        "fps": (NUMBER, "frames per second of a moving body (default: the file's own, or 24)"),
        "time": (NUMBER, "time at which a moving body stands still [s] (default: it moves)"),
        "clip": (str, "name of the animation of a .glb or .gltf (default: the first)"),
        "lead_in": (
            (int, float, str),
            "motion from a rest pose or open arms into the clip [s], or off (default: if needed)",
        ),
        "pose": ((str, list), "the body in other poses, to which it moves: FILE, or FILE@SECONDS of a clip"),
        "units": (str, "m, cm or mm (default: recognised from the size)"),
        "up": (str, "y or z (default: recognised)"),
        "front": (str, "axis of the file that the body faces, such as -z (default: recognised)"),
        "only": (list, "names of the parts that are the body, with wildcards"),
        "without": (list, "names of parts that are not (hair, lashes, helpers, floors: recognised)"),
        "measurements": ((str, dict), "file or table [cm, degrees] of those used instead of toile's"),
        "height": (NUMBER, "height of the built-in mannequin [m], instead of a file"),
        "chest": (NUMBER, "its chest circumference [m]"),
        "waist": (NUMBER, "its waist circumference [m]"),
        "hip": (NUMBER, "its hip circumference [m]"),
    },
    "garment": {
        "source": (
            str,
            "built-in name, GarmentCode .json, DXF or FreeSewing .svg pattern, "
            "or mesh: .obj .ply .glb .npz .vtu .vtk .xdmf .inp .msh",
        ),
        "name": (str, "name of the output files"),
        "fabric": (str, "preset or [fabric.NAME]"),
        "panel_fabrics": (dict, 'fabric of panels that are of another: { collar = "denim-12oz" }'),
        "folds": (dict, "lines that are folded: { front = [{ points = [[x, y], [x, y]], degrees = 180 }] }"),
        "self_contact": (bool, "false, for all garments, leaves out contact of cloth with cloth"),
        "pins": (list, "edge labels and vertex numbers held in place"),
        "warp_angle": ((int, float, dict), "rotation of the warp direction [degrees], or panel = degrees"),
        "units": (str, "m, cm or mm of a mesh file; also in of a DXF pattern"),
        "up": (str, "y or z of a mesh file"),
        "walls": (int, "layers that the two walls of a mesh with thickness are: 1 (default) or 2"),
        "size": (str, "size of a DXF pattern that holds several"),
        "allowance": (NUMBER, "seam allowance [m] of a DXF pattern without a sew line; 0: none is drawn"),
        "seams": ((str, list), 'seams file of a drawn pattern, or ["front.3 + back.2 = sleeve.1", ...]'),
        **GARMENT_KEYS,
    },
    **PART_KEYS,
    "obstacle": OBSTACLE_KEYS,
    "fabric": FABRIC_KEYS,
}
"""Table name to key to (accepted types, meaning)."""
PLAIN_KEYS = (
    "quality", "edge_length", "max_frames", "gravity", "ground", "friction", "formats", "fit", "certificate",
    "threads",
)  # fmt: skip
"""Keys of the top level that a Scene takes as they are."""
FILE_KEYS = ("units", "up", "front", "only", "without", "fps", "time", "clip", "lead_in", "pose")
"""Keys of [avatar] that say how its file is read."""
TYPE_NAMES = {str: "a text", bool: "true or false", int: "a whole number", float: "a number", list: "a list"}


def load_scene(path: str | Path) -> Scene:
    """Return the scene of a TOML file. Raises InputError naming the file, its line and what to do."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such scene file; check the path", file=path) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as a scene file ({error})", file=path) from None
    try:
        data = parse_toml(text)
    except ValueError as error:
        raise InputError(f"{path}: not valid TOML: {error}", file=path) from None
    return _SceneReader(path, LineNumbers(text)).scene(data)


def scene_of_line(data: dict[str, Any], path: Path, line: int) -> Scene:
    """Return the scene of data with the keys of a scene file, from one line of another kind of file."""
    return _SceneReader(path, OneLine(line)).scene(data)


def scene_keys_help() -> str:
    """Return the table of all keys as text."""
    lines: list[str] = []
    for table, keys in SCENE_KEYS.items():
        heading = {"": "top level", "fabric": "[fabric.NAME]", **PART_HEADINGS, **OBSTACLE_HEADING}
        lines.append(heading.get(table, f"[{table}]"))
        lines += [f"  {key:<19}{meaning}" for key, (_, meaning) in keys.items()]
    return "\n".join(lines)


class _SceneReader:
    """Turns parsed TOML into a Scene; knows the file and line of each key for errors."""

    def __init__(self, path: Path, lines: LineNumbers | OneLine) -> None:
        self.path = path
        self.lines = lines

    def scene(self, data: dict[str, Any]) -> Scene:
        """Return the scene."""
        self._check_keys(data, "", ())
        own = {name: self._fabric(name, values) for name, values in data.get("fabric", {}).items()}
        if not data.get("garment"):
            raise InputError(
                f"{self.path}: the scene has no [[garment]] table; add one with a source", file=self.path,
                field="garment",
            )  # fmt: skip
        garments = tuple(
            self._garment(values, ("garment", index), own) for index, values in enumerate(data["garment"])
        )
        if "default_fabric" in data:
            self._check_fabric_name(data["default_fabric"], own, ("default_fabric",))
        plain = {key: data[key] for key in PLAIN_KEYS if key in data}
        tables: dict[str, Any] = {
            "friction_between": self._friction_between(data.get("friction_between", [])),
            "avatar": self._avatar(data.get("avatar", {})),
            "measurements": self._measurements(data.get("avatar", {}).get("measurements")),
            "remesh": self._remesh(data.get("remesh", True), data),
            "air": self._air(data["air"]) if "air" in data else None,
            "obstacles": self._obstacles(data.get("obstacle", [])),
        }
        with self._placed():
            return Scene(garments=garments, fabric=data.get("default_fabric"), fabrics=own, **tables, **plain)

    def _friction_between(self, entries: list[Any]) -> dict[tuple[str, str], float]:
        """Return friction of pairs, given as lists of two names and a number."""
        pairs = {}
        for entry in entries:
            if (
                not isinstance(entry, list)
                or [type(part) for part in entry[:2]] != [str, str]
                or len(entry) != 3
                or not isinstance(entry[2], NUMBER)
            ):
                needed = 'each entry is two fabrics (or a fabric and "body") and a number'
                raise self._error(("friction_between",), f"friction_between: {needed}, got {entry!r}")
            pairs[entry[0], entry[1]] = entry[2]
        return pairs

    def _remesh(self, values: bool | dict[str, Any], data: dict[str, Any]) -> bool | SizingOptions:
        """Return how the mesh adapts, from `remesh` and, for sizes that are missing, the quality."""
        if isinstance(values, bool):
            return values
        self._check_keys(values, "remesh", ("remesh",))
        with self._placed():
            quality = quality_preset(data.get("quality", "standard"))
        finest = data.get("edge_length", quality.edge_length)
        with self._placed("remesh"):
            with about(field="size_min"):
                sizing = quality.sizing(values.get("size_min", finest))
            # One after the other, so that an error belongs to a key; the shortest edges are set already.
            for key, value in values.items():
                with about(field=key):
                    sizing = replace(sizing, **{key: value})
        return sizing

    def _air(self, values: dict[str, Any]) -> Air:
        """Return the air of the [air] table."""
        self._check_keys(values, "air", ("air",))
        with self._placed("air"):
            return air_of(values)

    def _obstacles(self, tables: list[Any]) -> list[Obstacle]:
        """Return the obstacles of the [[obstacle]] tables."""
        found = []
        for index, table in enumerate(tables):
            with self._placed("obstacle", index):
                found.append(obstacle_of(table, self.path.parent))
        return found

    @contextmanager
    def _placed(self, *table: str | int) -> Iterator[None]:
        """Put file and line of the key at fault, in a table, in front of errors raised inside."""
        try:
            yield
        except InputError as error:
            raise self._at((*table, *key_path(error.field)), error) from None

    def _error(self, key: tuple[str | int, ...], message: str) -> InputError:
        """Return the error about a key, with file and line in front."""
        return self._at(key, InputError(message))

    def _at(self, key: tuple[str | int, ...], error: InputError) -> InputError:
        """Return an error with file and line of a key in front."""
        line = self.lines.of(key)
        where = f"{self.path}, line {line}" if line else str(self.path)
        return error.at(where, file=self.path, field=".".join(map(str, key)) or None)

    def _check_keys(self, values: Mapping[str, Any], table: str, place: tuple[str | int, ...]) -> None:
        """Raise InputError for an unknown key or a value of the wrong type."""
        known = SCENE_KEYS[table]
        for key, value in values.items():
            if key not in known:
                raise self._error((*place, key), unknown_name("key", key, known))
            accepted = known[key][0] if isinstance(known[key][0], tuple) else (known[key][0],)
            if not isinstance(value, accepted) or (isinstance(value, bool) and bool not in accepted):
                if table == "" and key == "fabric" and isinstance(value, str):
                    raise self._error(
                        (key,), f"[fabric.NAME] tables define fabrics; say default_fabric = '{value}'"
                    )
                wanted = " or ".join(dict.fromkeys(TYPE_NAMES.get(kind, "a table") for kind in accepted))
                raise self._error((*place, key), f"{key} must be {wanted}, got {value!r}")

    def _resolve(self, name: str) -> Path:
        """Return a path of the scene file, relative to it."""
        return self.path.parent / Path(name).expanduser()

    def _avatar(self, values: dict[str, Any]) -> AvatarFile | MannequinSize | None:
        """Return what the [avatar] table asks for."""
        self._check_keys(values, "avatar", ("avatar",))
        sizes = {key: values[key] for key in ("height", "chest", "waist", "hip") if key in values}
        if "file" not in values:
            if stray := next((key for key in FILE_KEYS if key in values), None):
                raise self._error(("avatar", stray), f"{stray} needs a file in [avatar]")
            return MannequinSize(**sizes) if sizes else None
        if sizes:
            key = next(iter(sizes))
            raise self._error(("avatar", key), f"{key} sizes the built-in mannequin; remove it or file")
        for choice in ("only", "without"):
            if not all(isinstance(name, str) for name in values.get(choice, ())):
                raise self._error(
                    ("avatar", choice), f"{choice} lists names of parts, got {values[choice]!r}"
                )
        said = {key: values[key] for key in FILE_KEYS if key in values}
        said["pose"] = moved_poses(values.get("pose", ()), lambda path: self._resolve(str(path)))
        return AvatarFile(path=self._resolve(values["file"]), **said)

    def _measurements(self, values: str | dict[str, Any] | None) -> Path | Mapping[str, Any] | None:
        """Return the measurements of the [avatar] table, or their file."""
        if isinstance(values, str):
            return self._resolve(values)
        if values is None:
            return None
        try:
            return measurements_of(values)
        except InputError as error:
            raise self._at(("avatar", *(error.field or "").split(".")), error) from None

    def _garment(self, values: Any, place: tuple[str | int, ...], own: Mapping[str, Fabric]) -> Garment:
        """Return the garment of one [[garment]] table."""
        if not isinstance(values, dict):
            raise self._error(("garment",), "garment must be a list of tables: write [[garment]]")
        with about(garment=_name_of(values)):
            return self._checked_garment(values, place, own)

    def _checked_garment(
        self, values: dict[str, Any], place: tuple[str | int, ...], own: Mapping[str, Fabric]
    ) -> Garment:
        """Return the garment of a table whose keys and values are yet to be checked."""
        self._check_keys(values, "garment", place)
        if "source" not in values:
            raise self._error(place, "a [[garment]] needs a source: a built-in name or a file")
        if "fabric" in values:
            self._check_fabric_name(values["fabric"], own, (*place, "fabric"))
        for panel, fabric in values.get("panel_fabrics", {}).items():
            if not isinstance(fabric, str):
                raise self._error((*place, "panel_fabrics"), f"{panel}: a fabric is a name, got {fabric!r}")
            self._check_fabric_name(fabric, own, (*place, "panel_fabrics"))
        for pin in values.get("pins", []):
            if isinstance(pin, bool) or not isinstance(pin, str | int):
                raise self._error((*place, "pins"), f"pins are edge labels or vertex numbers, got {pin!r}")
        angle = values.get("warp_angle", 0.0)
        for value in angle.values() if isinstance(angle, dict) else [angle]:
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise self._error((*place, "warp_angle"), f"warp_angle is in degrees, got {value!r}")
        with self._placed(*place):
            parts = read_parts(values, self.path.parent)
        source: str = values["source"]
        seams: str | list[str] | None = values.get("seams")
        with self._placed(*place):
            folds = folds_of(values.get("folds", {}))
        is_file = bool(re.search(r"[./\\]", source))
        return Garment(
            self._resolve(source) if is_file else source,
            fabric=values.get("fabric"),
            name=values.get("name"),
            self_contact=values.get("self_contact", True),
            pins=tuple(values.get("pins", ())),
            warp_angle=angle,
            units=values.get("units"),
            up=values.get("up"),
            walls=values.get("walls", 1),
            size=values.get("size"),
            allowance=values.get("allowance"),
            panel_fabrics=values.get("panel_fabrics", {}),
            folds=folds,
            seams=self._resolve(seams) if isinstance(seams, str) else seams,
            **vars(parts),
        )

    def _check_fabric_name(self, name: str, own: Mapping[str, Fabric], key: tuple[str | int, ...]) -> None:
        """Raise InputError with the nearest name if the fabric is neither the file's nor a preset."""
        known = [*own, *(preset for preset in fabrics() if preset not in own)]
        if name not in known:
            raise self._error(key, unknown_name("fabric", name, known))

    def _fabric(self, name: str, values: Any) -> Fabric:
        """Return the fabric of one [fabric.NAME] table."""
        place = ("fabric", name)
        if not isinstance(values, dict):
            raise self._error(place, f"fabric.{name} must be a table: write [fabric.{name}]")
        self._check_keys(values, "fabric", place)
        with self._placed(*place):
            base = supplied_values(values)
        given = {key: value for key, value in values.items() if key not in SUPPLIERS}
        needed = {entry.name for entry in fields(Fabric) if entry.default is MISSING} - {"name"}
        missing = sorted(needed - base.keys() - given.keys())
        if missing:
            raise self._error(place, f"fabric '{name}' lacks {', '.join(missing)}; set them, like or yarn")
        try:
            return checked_fabric(Fabric(**{**base, **given, "name": name}))
        except InputError as error:
            raise self._at((*place, str(error.field).removeprefix("fabric.")), error) from None


def _name_of(values: Mapping[str, Any]) -> str | None:
    """Return the name of the garment of a table that is yet to be checked, None if it has none."""
    name, source = values.get("name"), values.get("source")
    if isinstance(name, str):
        return name
    return default_name(Garment(source)) if isinstance(source, str) else None
