"""Checkpoints of a run in its output folder, from which it can be resumed.

Scene and state are Python pickles, as `multiprocessing` uses them: resume only what you trust. They are
removed when a run has ended by itself.
"""

import pickle
import re
import shutil
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.place import Place
from toile.dressing.files.writers.atomic import writable_folder, write_atomic
from toile.dressing.run.resolved_scene import ResolvedScene
from toile.dressing.run.result import DressedGarment
from toile.dressing.run.scene import AvatarFile
from toile.dressing.wear.drape_types import DrapeOutcome
from toile.geometry.errors import InputError
from toile.remesh.sizing.sizing import SizingOptions

if TYPE_CHECKING:
    from toile.engine.film.plan import FilmState

FOLDER = ".resume"
SCENE, HUNG, FRAME = "scene", "hung", "frame"
FRAMES, FILM = "frames", "dressed.usdc"
"""Names in the output folder of the frames of a film, and of the file that holds them all."""
FRAME_FILE = re.compile(r".+\.\d{4,}\.ply")
"""Names of the files of frames."""


@dataclass(frozen=True, kw_only=True)
class Hung:
    """A scene whose garments hang.

    Attributes
    ----------
    avatar
        The avatar at the first frame, in the room of its file.
    body
        The same in its own frame, with its motion.
    place
        Where that frame is in the room.
    drape
        How the drape ended, in the body's frame.
    garments
        As they hang, in the room.
    report
        Its figures.
    sizing
        How its mesh adapts, or None.
    """

    avatar: Avatar
    body: Avatar
    place: Place
    drape: DrapeOutcome
    garments: tuple[DressedGarment, ...]
    report: dict[str, Any]
    sizing: SizingOptions | None


class Checkpoint:
    """The traces of one run in its output folder, `output`."""

    def __init__(self, output: Path) -> None:
        self.output = output
        self.folder = output / FOLDER

    def begin(self, scene: ResolvedScene) -> None:
        """Forget an earlier run, with its film, and note the scene."""
        self.end()
        self._remove_film()
        writable_folder(self.folder)
        self._write(SCENE, _with_whole_paths(scene))

    def hung(self, hung: Hung) -> None:
        """Note that the garments hang."""
        self._write(HUNG, hung)

    def frame(self, state: "FilmState") -> None:
        """Note a frame."""
        self._write(FRAME, state)

    def end(self) -> None:
        """Remove all traces."""
        if self.folder.is_dir():
            shutil.rmtree(self.folder)

    def _remove_film(self) -> None:
        """Remove the frames of an earlier run, of which there may be more, and nothing else."""
        frames = self.output / FRAMES
        if frames.is_dir():
            for path in list(frames.iterdir()):
                if FRAME_FILE.fullmatch(path.name):
                    path.unlink()
            if not any(frames.iterdir()):
                frames.rmdir()
        (self.output / FILM).unlink(missing_ok=True)

    def load(self) -> "tuple[ResolvedScene, Hung | None, FilmState | None]":
        """Return what was noted last. Raises InputError if there is nothing to resume."""
        from toile.engine.film.plan import FilmState

        scene, hung, state = self._read(SCENE), self._read(HUNG), self._read(FRAME)
        if not isinstance(scene, ResolvedScene):
            raise InputError(
                f"{self.output}: there is no run to resume; it has ended, or never wrote here",
                file=self.output,
            )
        return (
            scene,
            hung if isinstance(hung, Hung) else None,
            state if isinstance(state, FilmState) and isinstance(hung, Hung) else None,
        )

    def _write(self, name: str, content: object) -> None:
        write_atomic(self.folder / name, pickle.dumps((version("toile"), content), protocol=5))

    def _read(self, name: str) -> object:
        path = self.folder / name
        if not path.is_file():
            return None
        try:
            wrote, content = pickle.loads(path.read_bytes())
        except Exception as error:  # whatever a damaged pickle may raise
            raise InputError(
                f"{path}: is damaged ({type(error).__name__}); start the run again", file=path
            ) from None
        if wrote != version("toile"):
            raise InputError(
                f"{path}: toile {wrote} wrote it, this is {version('toile')}; start the run again", file=path
            )
        return content


def _with_whole_paths(scene: ResolvedScene) -> ResolvedScene:
    """Return a scene that can be read from any folder."""
    avatar = scene.avatar
    if isinstance(avatar, AvatarFile):
        avatar = replace(avatar, path=avatar.path.absolute())
    garments = tuple(
        replace(garment, source=garment.source.absolute()) if isinstance(garment.source, Path) else garment
        for garment in scene.garments
    )
    measurements = scene.measurements
    if isinstance(measurements, Path):
        measurements = measurements.absolute()
    return replace(scene, avatar=avatar, measurements=measurements, garments=garments)
