"""The files that a scene is made from, and their hashes."""

import hashlib
import re
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.files.on_disk import is_file, is_folder
from toile.dressing.pattern.drawn.read_drawn import DRAWN_FORMATS
from toile.dressing.pattern.drawn.seams_file import seams_file_of
from toile.dressing.run.scene import AvatarFile

if TYPE_CHECKING:
    from toile.dressing.run.resolved_scene import ResolvedScene


def files_of(path: Path) -> list[Path]:
    """Return the files behind a path of a scene: itself and what it needs beside it, or a folder's files."""
    if is_folder(path):
        return sorted(entry for entry in path.iterdir() if entry.is_file())
    if path.suffix.lower() == ".gltf" and is_file(path):
        named = re.findall(r'"uri"\s*:\s*"([^"]+)"', path.read_text(encoding="utf-8", errors="replace"))
        return [path, *(path.parent / name for name in named if not name.startswith("data:"))]
    if path.suffix.lower() in DRAWN_FORMATS:
        beside = seams_file_of(path)
        return [path, beside] if is_file(beside) else [path]
    return [path]


def input_hashes(scene: "ResolvedScene") -> list[dict[str, str]]:
    """Return name and SHA-256 of every file of a scene, and what it is of; where files lie does not count."""
    named: list[tuple[str, Path]] = []
    if isinstance(scene.avatar, AvatarFile):
        named.append(("avatar", scene.avatar.path))
    if isinstance(scene.measurements, Path):
        named.append(("measurements", scene.measurements))
    for garment in scene.garments:
        for path in (garment.source, garment.seams):
            if isinstance(path, Path):
                named.append((f"garment {garment.name}", path))
    found = []
    for of, path in named:
        for file in files_of(path):
            with open(file, "rb") as stream:
                digest = hashlib.file_digest(stream, "sha256").hexdigest()
            found.append({"of": of, "file": file.name, "sha256": digest})
    return found
