"""Checkpoints of a run in its output folder, from which it can be resumed; removed when it has ended."""

import shutil
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.place import Place
from toile.dressing.body.posing.posed_body import moved_poses
from toile.dressing.files.writers.atomic import writable_folder, write_atomic
from toile.dressing.run.output.earlier_run import remove_earlier_run
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
"""Names of the files of scene, garments that hang, and last frame."""


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
        """Forget an earlier run with all that it wrote, and note the scene."""
        remove_earlier_run(self.output, self._garments())
        self.end()
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

    def _garments(self) -> tuple[str, ...]:
        """Return the names of the garments of a run that did not end."""
        try:
            scene = self._read(SCENE)
        except InputError:
            return ()
        return tuple(garment.name for garment in scene.garments) if isinstance(scene, ResolvedScene) else ()

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
        from toile.dressing.run.output.state_file import state_bytes

        write_atomic(self.folder / f"{name}.npz", state_bytes((version("toile"), content)))

    def _read(self, name: str) -> object:
        from toile.dressing.run.output.state_file import read_state

        path = self.folder / f"{name}.npz"
        if not path.is_file():
            return None
        state = read_state(path)
        if not isinstance(state, tuple) or len(state) != 2:
            raise InputError(f"{path}: is damaged; start the run again", file=path)
        wrote, content = state
        if wrote != version("toile"):
            raise InputError(
                f"{path}: toile {wrote} wrote it, this is {version('toile')}; start the run again", file=path
            )
        found: object = content
        return found


def _with_whole_paths(scene: ResolvedScene) -> ResolvedScene:
    """Return a scene that can be read from any folder."""
    avatar = scene.avatar
    if isinstance(avatar, AvatarFile):
        avatar = replace(avatar, path=avatar.path.absolute(), pose=moved_poses(avatar.pose, Path.absolute))
    garments = tuple(
        replace(garment, source=garment.source.absolute()) if isinstance(garment.source, Path) else garment
        for garment in scene.garments
    )
    measurements = scene.measurements
    if isinstance(measurements, Path):
        measurements = measurements.absolute()
    obstacles = tuple(
        replace(one, source=one.path.absolute()) if one.path is not None else one for one in scene.obstacles
    )
    return replace(scene, avatar=avatar, measurements=measurements, garments=garments, obstacles=obstacles)
