"""Folders of frames: one for every run of every garment, who uses it, and when it may go.

`//toile_FILE/OBJECT/RUN/` is made for a single run of a single object and never used again while Blender is
open, so that neither copies nor objects of a like name meet in it, and no file changes that Blender holds
open. Beside the frames, `used_by.json` lists the .blend files that show them.
"""

import json
import os
import re
from pathlib import Path
from typing import Any, ClassVar

import bpy

USED_BY = "used_by.json"
FRAMES = ("*.usdc", "*.pc2", "toile.json", USED_BY)
MARK = "toile_frames"
"""Custom property of the cache files that are toile's."""


class _Session:
    """What this Blender has done since it started."""

    made: ClassVar[set[str]] = set()
    """Folders that were made or shown; none is made again."""
    before: ClassVar[dict[str, str]] = {}
    """The folder that an object showed before, by the one that took its place: undo leads back to it."""
    loaded = 0.0
    """When the open file was saved last before it was opened [s since 1970]."""


def file_stem(name: str) -> str:
    """Return a name that every file system and USD accept."""
    return re.sub(r"[^\w-]+", "_", name).strip("_") or "garment"


def new_folder(name: str) -> Path:
    """Make a folder for a run of the object of that name, one that nothing has used before."""
    blend = Path(bpy.data.filepath)
    place = blend.parent / f"toile_{blend.stem}" / file_stem(name)
    place.mkdir(parents=True, exist_ok=True)
    taken = _Session.made | _shown()
    number = 1
    while True:
        folder = place / str(number)
        number += 1
        if str(folder) in taken:
            continue
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        _Session.made.add(str(folder))
        _write_users(folder, [blend])
        return folder


def relative(path: Path) -> str:
    """Return a path as Blender writes it, relative to the .blend file where that is possible."""
    try:
        return str(bpy.path.relpath(str(path)))
    except ValueError:  # another drive
        return str(path)


def shown_folder(obj: Any, modifier: Any) -> Path | None:
    """Return the folder of the frames that a modifier of an object shows, None where it shows none."""
    if modifier is None:
        return None
    if modifier.type == "MESH_CACHE":
        return _absolute(modifier.filepath, obj.library)
    cache = modifier.cache_file
    return None if cache is None else _absolute(cache.filepath, cache.library)


def replaced(old: Path | None, new: Path) -> None:
    """Note that an object shows the frames of another run; those of the run before the last may go."""
    if old is None or old == new:
        return
    oldest = _Session.before.pop(str(old), None)
    if oldest is not None:
        forget(Path(oldest))
    _Session.before[str(new)] = str(old)
    _Session.made.add(str(old))


def forget(folder: Path) -> str:
    """Remove the frames in a folder, unless somebody else shows them; return who, or nothing.

    What the object showed before goes with them.
    """
    oldest = _Session.before.pop(str(folder), None)
    if oldest is not None:
        forget(Path(oldest))
    if str(folder) in _shown():
        return "another object shows them"
    others = [user.name for user in _users(folder) if user.is_file() and not _is_present(user)]
    if others:
        return f"{' and '.join(others)} shows them"
    for pattern in FRAMES:
        for file in folder.glob(pattern):
            file.unlink(missing_ok=True)
    for place in (folder, folder.parent, folder.parent.parent):
        if place.is_dir() and not any(place.iterdir()):
            place.rmdir()
    return ""


def note_user(saved: str) -> None:
    """Note in all folders that objects show that a .blend file which was just saved shows them, too."""
    blend = Path(saved or bpy.data.filepath)
    for name in _shown(linked=False):
        folder = Path(name)
        users = _users(folder)
        if folder.is_dir() and blend not in users:
            _write_users(folder, [*users, blend])


def note_loaded() -> None:
    """Note what was there when a file was opened."""
    blend = Path(bpy.data.filepath)
    _Session.loaded = blend.stat().st_mtime if bpy.data.filepath and blend.is_file() else 0.0
    _Session.before.clear()


def sweep() -> None:
    """Remove frames of the open file that no object shows: those of objects that were removed.

    What came after the file had been saved last before it was opened stays: frames that a crash, or another
    Blender, has not saved yet.
    """
    blend = Path(bpy.data.filepath)
    kept = _Session.made | _shown()
    for note in sorted((blend.parent / f"toile_{blend.stem}").glob(f"*/*/{USED_BY}")):
        if str(note.parent) not in kept and note.stat().st_mtime < _Session.loaded:
            forget(note.parent)


def remove_orphans() -> None:
    """Remove cache files of toile that no modifier uses any more."""
    lone = [cache for cache in bpy.data.cache_files if MARK in cache and not cache.users]
    if lone:
        bpy.data.batch_remove(lone)


def _shown(*, linked: bool = True) -> set[str]:
    """Return the folders of all frames that objects show."""
    found = {
        _absolute(cache.filepath, cache.library)
        for cache in bpy.data.cache_files
        if cache.users and (linked or cache.library is None)
    }
    found |= {
        _absolute(modifier.filepath, obj.library)
        for obj in bpy.data.objects
        if linked or obj.library is None
        for modifier in obj.modifiers
        if modifier.type == "MESH_CACHE"
    }
    return {str(folder) for folder in found}


def _absolute(path: str, library: Any) -> Path:
    """Return the folder of a file that Blender names."""
    return Path(os.path.normpath(bpy.path.abspath(path, library=library))).parent


def _users(folder: Path) -> list[Path]:
    """Return the .blend files that show the frames in a folder, as far as it is noted."""
    try:
        names = json.loads((folder / USED_BY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        # Frames of version 0.1 lie in the folder of their object.
        blend = folder.parent.parent / f"{folder.parent.name.removeprefix('toile_')}.blend"
        return [blend] if blend.is_file() else []
    return [Path(os.path.normpath(folder / name)) for name in names]


def _write_users(folder: Path, blends: list[Path]) -> None:
    names = [
        os.path.relpath(blend, folder) if blend.drive == folder.drive else str(blend) for blend in blends
    ]
    (folder / USED_BY).write_text(json.dumps(names), encoding="utf-8")


def _is_present(blend: Path) -> bool:
    """Whether a .blend file is the one that is open."""
    return bool(bpy.data.filepath) and blend.samefile(bpy.data.filepath)
