"""What users say of obstacles beside the body."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.reading import Reading
from toile.engine.forces.contact_pairs import BODY
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, real, shown

FARTHEST = 100.0
"""Farthest that an obstacle may be moved [m]."""
MOST_FRICTION = 10.0

Numbers = tuple[float, float, float]
STILL: Numbers = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class ObstacleKey:
    """Where an obstacle is at a time of a film.

    Attributes
    ----------
    time
        Seconds from frame 0.
    move
        How far it is from where its file has it [m], in the room, Y up.
    turn
        Its rotation about its middle: axis times angle [degrees].

    Raises InputError naming what is no number.
    """

    time: float
    move: Numbers = STILL
    turn: Numbers = STILL

    def __post_init__(self) -> None:
        """Check every number."""
        object.__setattr__(
            self, "time", real(self.time, "time of an obstacle's key", 0.0, 1e5, "s", field="keys")
        )
        for name, most in (("move", FARTHEST), ("turn", 1e6)):
            object.__setattr__(self, name, _three(getattr(self, name), f"{name} of an obstacle's key", most))


@dataclass(frozen=True)
class Obstacle:
    """A solid beside the body: furniture, a hanger, a ball. It stands still, is moved by keys, or deforms.

    Attributes
    ----------
    source
        Path of a file of any kind that a body may have; one that moves (.npz, animated glTF, a folder of
        meshes) deforms. Or an Avatar in memory, in metres, with its motion if it has one.
    name
        Name in messages and in `friction_between`; None takes that of the source.
    friction
        Coulomb coefficient of all cloth on it; None: what cloth has on the body.
    keys
        Where it is over a film, straight and at constant speed between two keys; before the first and after
        the last it stays. A drape has it where the film begins.
    units, up
        Of its file: "m", "cm" or "mm", "y" or "z"; None takes those of the avatar's file, if it has one.
    fps
        Frames per second of a file that deforms, and of the film where the body stands still; None takes the
        file's own, or 24.
    clip
        Name of the animation of a glTF file; None takes the first.

    Raises InputError naming the field that is at fault.
    """

    source: str | Path | Avatar
    name: str | None = None
    friction: float | None = None
    keys: Sequence[ObstacleKey] = field(default=())
    units: str | None = None
    up: str | None = None
    fps: float | None = None
    clip: str | None = None

    def __post_init__(self) -> None:
        """Check every field."""
        if isinstance(self.source, str):
            object.__setattr__(self, "source", Path(self.source))
        if not isinstance(self.source, Path | Avatar):
            raise InputError(
                f"obstacle: source must be a file or an Avatar, got {shown(self.source)}", field="source"
            )
        for name in ("name", "clip"):
            value = getattr(self, name)
            if value is not None and not isinstance(value, str):
                raise InputError(f"obstacle: {name} must be a text, got {shown(value)}", field=name)
        if self.friction is not None:
            object.__setattr__(
                self,
                "friction",
                real(self.friction, "friction of an obstacle", 0.0, MOST_FRICTION, "", field="friction"),
            )
        if self.fps is not None:
            object.__setattr__(
                self, "fps", real(self.fps, "fps of an obstacle", 0.1, 10_000.0, "", field="fps")
            )
        Reading(units=self.units, up=self.up).check(self.called)
        object.__setattr__(self, "keys", self._checked_keys())

    @property
    def called(self) -> str:
        """Its name."""
        if self.name is not None:
            return self.name
        return self.source.name if isinstance(self.source, Avatar) else Path(self.source).stem

    @property
    def path(self) -> Path | None:
        """Its file, or None."""
        return self.source if isinstance(self.source, Path) else None

    def _checked_keys(self) -> tuple[ObstacleKey, ...]:
        keys = tuple(self.keys) if isinstance(self.keys, list | tuple) else (self.keys,)
        if not all(isinstance(key, ObstacleKey) for key in keys):
            raise InputError(
                f"obstacle {self.called}: keys must be ObstacleKeys, got {shown(self.keys)}", field="keys"
            )
        times = [key.time for key in keys]
        if any(later <= sooner for sooner, later in pairwise(times)):
            raise InputError(f"obstacle {self.called}: times of keys must rise, got {times}", field="keys")
        return keys


def _three(value: object, what: str, most: float) -> Numbers:
    """Return three numbers. Raises InputError unless they are."""
    entries = list(value) if isinstance(value, Sequence) and not isinstance(value, str) else []
    if len(entries) != 3 or not all(is_real(entry) and abs(entry) <= most for entry in entries):
        raise InputError(f"{what} must be three numbers up to {most:g}, got {shown(value)}", field="keys")
    x, y, z = (float(entry) for entry in entries)
    return x, y, z


def given_obstacles(given: object) -> tuple[Obstacle, ...]:
    """Return obstacles, given as a list; a path or an Avatar stands for an Obstacle with defaults.

    Raises InputError if they are none, or if two have one name.
    """
    if not isinstance(given, list | tuple):
        raise InputError(f"obstacles must be a list of Obstacles, got {shown(given)}", field="obstacles")
    found = tuple(one if isinstance(one, Obstacle) else Obstacle(one) for one in given)
    names = [one.called for one in found]
    twice = next((name for name in names if names.count(name) > 1 or name == BODY), None)
    if twice is not None:
        raise InputError(f"obstacle {twice}: that name is taken; give it a name", field="obstacles")
    return found
