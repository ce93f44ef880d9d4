"""Obstacles from the tables of a scene file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from toile.dressing.body.obstacles.obstacle import Obstacle, ObstacleKey
from toile.dressing.files.suggestion import unknown_name
from toile.geometry.errors import InputError

NUMBER = (int, float)
OBSTACLE_KEYS: dict[str, tuple[Any, str]] = {
    "file": (str, "the solid, of any kind that a body may have; .npz, animated .glb, folder: it deforms"),
    "name": (str, "its name in friction_between (default: that of the file)"),
    "friction": (NUMBER, "friction of all cloth on it (default: that on the body)"),
    "keys": (list, "where it is: [{ time = 0, move = [x, y, z], turn = [degrees about x, y, z] }, ...]"),
    "units": (str, "m, cm or mm (default: those of the avatar's file)"),
    "up": (str, "y or z (default: that of the avatar's file)"),
    "fps": (NUMBER, "frames per second of a solid that moves, where the body stands (default: own or 24)"),
    "clip": (str, "name of the animation of a .glb or .gltf (default: the first)"),
}
"""Keys of [[obstacle]] to their accepted types and meanings."""
OBSTACLE_HEADING = {"obstacle": "[[obstacle]]"}
KEYS = ("time", "move", "turn")


def obstacle_of(table: Mapping[str, Any], folder: Path) -> Obstacle:
    """Return the obstacle of a table; its file is relative to a folder. Raises InputError naming the key."""
    if not isinstance(table, Mapping):
        raise InputError("obstacle must be a list of tables: write [[obstacle]]")
    for name, value in table.items():
        if name not in OBSTACLE_KEYS:
            raise InputError(unknown_name("key", name, OBSTACLE_KEYS), field=name)
        if not isinstance(value, OBSTACLE_KEYS[name][0]) or isinstance(value, bool):
            raise InputError(f"{name} of an obstacle cannot be {value!r}", field=name)
    if "file" not in table:
        raise InputError("an [[obstacle]] needs a file", field="file")
    given = {name: value for name, value in table.items() if name not in ("file", "keys")}
    keys = tuple(_key(entry) for entry in table.get("keys", ()))
    return Obstacle(folder / Path(table["file"]).expanduser(), keys=keys, **given)


def _key(entry: object) -> ObstacleKey:
    if not isinstance(entry, Mapping) or "time" not in entry:
        raise InputError(f"a key of an obstacle is a table with a time, got {entry!r}", field="keys")
    for name in entry:
        if name not in KEYS:
            raise InputError(f"keys of an obstacle: {unknown_name('key', name, KEYS)}", field="keys")
    return ObstacleKey(**entry)
