"""Jobs from lists: every garment on every body in every fabric."""

import glob
import os
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from toile.dressing.batch.job import Job
from toile.dressing.files.read_surface import FORMATS as AVATAR_FORMATS
from toile.dressing.files.usd_file import FORMATS as USD_FORMATS
from toile.dressing.garment.fabrics import fabric
from toile.dressing.garment.mesh_garment import FORMATS as MESH_FORMATS
from toile.dressing.run.garment_source import built_in_name
from toile.dressing.run.result import file_stem
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.geometry.errors import InputError

MANNEQUIN = "mannequin"
"""The word that stands for the built-in body."""


class JobGrid:
    """Every combination of bodies, garments and fabrics, by names of files."""

    def __init__(
        self, avatars: Sequence[str], garments: Sequence[str], fabrics: Sequence[str], options: dict[str, Any]
    ) -> None:
        """Look up what there is.

        Parameters
        ----------
        avatars
            Patterns of files, as in a shell, or "mannequin"; none is the mannequin.
        garments
            Patterns of files, or built-in names.
        fabrics
            Presets; none is the default.
        options
            Fields of all scenes.

        Raises
        ------
        InputError
            If a pattern matches nothing, or a name is unknown.
        """
        self.notes: list[str] = []
        bodies = self._found(
            "--avatars", avatars or [MANNEQUIN], (*AVATAR_FORMATS, ".npz", *USD_FORMATS), MANNEQUIN
        )
        clothes = self._found("--garments", garments, (".json", *MESH_FORMATS), None)
        self._avatars = list(zip(unique_names(bodies), bodies, strict=True))
        self._garments = list(zip(unique_names(clothes), clothes, strict=True))
        for name in fabrics:
            fabric(name)
        self._fabrics: list[str | None] = [*dict.fromkeys(fabrics)] or [None]
        self._options = options

    def __len__(self) -> int:
        """Return the number of jobs."""
        return len(self._avatars) * len(self._garments) * len(self._fabrics)

    def __iter__(self) -> Iterator[Job]:
        """Go through the jobs, body by body."""
        for (body, avatar), (clothing, source), cloth in product(
            self._avatars, self._garments, self._fabrics
        ):
            names = [body, clothing, *([] if cloth is None else [cloth])]
            scene = Scene(
                avatar=None if avatar == MANNEQUIN else AvatarFile(path=Path(avatar)),
                garments=[Garment(source)],
                fabric=cloth,
                **self._options,
            )
            yield Job("__".join(names), scene)

    def _found(
        self, option: str, patterns: Sequence[str], extensions: Sequence[str], word: str | None
    ) -> list[str]:
        """Return the files of some patterns and built-in names, each once."""
        found: dict[str, None] = {}
        for pattern in patterns:
            name = word if pattern == word else None if word else built_in_name(pattern)
            if name:
                found[name] = None
                continue
            matches = _matches(pattern)
            # A file that is named is meant; of what a pattern matches, files of other kinds are not.
            fitting = [path for path in matches if path == pattern or Path(path).suffix.lower() in extensions]
            if not fitting:
                raise InputError(
                    f"{option} {pattern!r}: no file matches; check the path, and put patterns in quotes",
                    field=option,
                )
            if len(fitting) < len(matches):
                other = len(matches) - len(fitting)
                self.notes.append(f"{option} {pattern!r}: {other} files of other kinds are left out")
            found |= dict.fromkeys(fitting)
        return list(found)


def _matches(pattern: str) -> list[str]:
    """Return the paths of a pattern; brackets are a set of signs, or stand in the names of files and folders.

    What exists by its very name is meant by it.
    """
    if os.path.exists(pattern):
        return [pattern]
    parts = Path(pattern).parts
    known = next(k for k in range(len(parts), -1, -1) if os.path.exists(Path(*parts[:k])))
    rest = parts[known:]
    folder = [glob.escape(part) for part in parts[:known]]
    literal = [part.replace("[", "[[]") for part in rest]
    for end in (rest, literal):
        found = glob.glob(str(Path(*folder, *end)), recursive=True)
        if found:
            return sorted(found)
    return []


def unique_names(sources: Sequence[str]) -> list[str]:
    """Return a short name per source, with as much of its path as tells it from the others."""
    for name in (_stem, lambda source: Path(source).name, lambda source: source):
        names = [file_stem(name(source)) for source in sources]
        if len({name.lower() for name in names}) == len(names):
            return names
    raise InputError(f"names of files differ only in special characters: {', '.join(sources)}; rename them")


def _stem(source: str) -> str:
    """Return the name of a file without what all patterns end in."""
    return Path(source).stem.removesuffix("_specification")
