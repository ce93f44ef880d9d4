"""The files that a scene is made from, and their hashes."""

from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.body.posing.posed_body import file_of
from toile.dressing.certificate.input_files import files_of, sha256_of
from toile.dressing.run.scene import AvatarFile

if TYPE_CHECKING:
    from toile.dressing.run.resolved_scene import ResolvedScene


def input_hashes(scene: "ResolvedScene") -> list[dict[str, str]]:
    """Return name and SHA-256 of every file of a scene, and what it is of; where files lie does not count."""
    named: list[tuple[str, Path]] = []
    if isinstance(scene.avatar, AvatarFile):
        named.append(("avatar", scene.avatar.path))
        named += [("pose", file_of(str(pose))[0]) for pose in scene.avatar.pose]
    named += [(f"obstacle {one.called}", one.path) for one in scene.obstacles if one.path is not None]
    if isinstance(scene.measurements, Path):
        named.append(("measurements", scene.measurements))
    for garment in scene.garments:
        for path in (garment.source, garment.seams):
            if isinstance(path, Path):
                named.append((f"garment {garment.name}", path))
    found = []
    for of, path in named:
        for file in files_of(path):
            found.append({"of": of, "file": file.name, "sha256": sha256_of(file)})
    return found
