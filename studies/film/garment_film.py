"""The films that are measured: a shirt on a walking body, a skirt that turns, layers; or what is given."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from toile.dressing.body.animated_avatar import load_animated_avatar
from toile.dressing.body.avatar import Avatar, load_avatar
from toile.dressing.body.stored_mannequin import stored_mannequin
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.files.writers.ply import ply_bytes
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.errors import InputError
from toile.studies.scenes.walking_mannequin import turn, walk

FRAMES = 48
"""Of the built-in bodies' motions: two seconds."""
GIVEN = "given"
"""Name of the film of a body and garments that the user gives."""
WALK_FILE = "anim_f_apose_to_walk.npz"
"""The walk for which `WALK_RATIO` was set."""
WALK_RATIO, RATIO, STILL_RATIO = 6.0, 4.0, 1.7
"""How many times less CPU time than the version it is measured against: that walk, other films, a drape."""


@dataclass(frozen=True, kw_only=True)
class GarmentFilm:
    """A film: garments from the body outwards, the moving body by number of frames, the ratio to reach.

    `ratio` is None where nothing was set.
    """

    name: str
    garments: tuple[str, ...]
    body: Callable[[int | None], tuple[Avatar, VertexMotion]]
    ratio: float | None

    def write_body(self, folder: Path, frames: int | None, still: bool) -> Path:
        """Write the body, moving or as it is at the start, where every version of toile can read it.

        `frames` is how many steps from frame to frame there are; None takes the film's own.
        """
        avatar, motion = self.body(None if frames is None else frames + 1)
        if still:
            path = folder / f"{self.name}.ply"
            write_atomic(path, ply_bytes(avatar.vertices, avatar.faces))
            return path
        path = folder / f"{self.name}.npz"
        np.savez(path, vertices=motion.frames[: None if frames is None else frames + 1], faces=avatar.faces,
                 fps=motion.fps)  # fmt: skip
        return path


def _walking(frames: int | None) -> tuple[Avatar, VertexMotion]:
    body = stored_mannequin()
    return body, walk(body, frames or FRAMES + 1)


def _turning(frames: int | None) -> tuple[Avatar, VertexMotion]:
    body = stored_mannequin()
    return body, turn(body, frames or FRAMES + 1)


FILMS = {
    film.name: film
    for film in (
        GarmentFilm(name="walk", garments=("tshirt",), body=_walking, ratio=None),
        GarmentFilm(name="skirt", garments=("circle_skirt",), body=_turning, ratio=RATIO),
        GarmentFilm(name="layers", garments=("trousers", "tshirt"), body=_walking, ratio=RATIO),
    )
}
"""The built-in films by name."""


def given_film(avatar: Path, garments: tuple[str, ...], still: bool) -> GarmentFilm:
    """Return the film of a body and garments. Raises InputError if the body does not move and should."""

    def body(frames: int | None) -> tuple[Avatar, VertexMotion]:
        if still and avatar.suffix.lower() != ".npz":
            loaded = load_avatar(avatar)
            return loaded, VertexMotion(frames=loaded.vertices[None], fps=24.0)
        loaded = load_animated_avatar(avatar)
        if loaded.motion is None:
            raise InputError(f"{avatar}: does not move; measure a drape on it with --still", file=avatar)
        return loaded, loaded.motion

    known = avatar.name == WALK_FILE and garments == ("tshirt",)
    return GarmentFilm(name=GIVEN, garments=garments, body=body, ratio=WALK_RATIO if known else None)
