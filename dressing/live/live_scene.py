"""Live cloth from a scene: `for frame in toile.live(scene)`."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import TracebackType

import numpy as np
import numpy.typing as npt

from toile.dressing.files.palette import BODY, garment_colour
from toile.dressing.garment.fabrics import fabric
from toile.dressing.live.audit_process import AuditProcess
from toile.dressing.live.sheet import Sheet, surface_of
from toile.dressing.run.air import Air
from toile.dressing.run.dress import FOLLOWS
from toile.dressing.run.hang import hang
from toile.dressing.run.listener import Listener, Say
from toile.dressing.run.resolved_scene import resolve
from toile.dressing.run.scene import Scene
from toile.engine.cloth.cloth import Cloth
from toile.engine.live.live_cloth import LiveCloth, LiveFrame
from toile.engine.live.obstacles import Surface
from toile.engine.step.options import StepOptions
from toile.geometry.errors import InputError

AUDIT_EVERY = 30
"""Steps from one audit to the next at least: half a second."""


class Live(LiveCloth):
    """Cloth that goes on while you play with it; iterate over it, or call `advance`.

    What is done to it between steps acts from the next one: `grip`, `pull_to` and `release`, `push.force`,
    `pin`, `unpin` and `move_pins`, `put_obstacle` and `move_obstacle`, `wind`, `fabric`, `change_options`.
    Nodes are numbered as the rows of `frame.positions`. Nothing passes through anything, whatever is done; a
    process of its own audits that twice a second, and `audit_process.last` has what it found.

    Attributes
    ----------
    names
        Of the garments.
    audit_process
        The audit in a process of its own, from the first step on; None before.
    """

    def __init__(
        self, cloth: Cloth, obstacles: Mapping[str, Surface], options: StepOptions, names: tuple[str, ...]
    ) -> None:
        super().__init__(cloth, obstacles, options)
        self.names = names
        self.audit_process: AuditProcess | None = None

    def __iter__(self) -> Iterator[LiveFrame]:
        """Yield the state after every step, without end."""
        while True:
            yield self.advance()

    def advance(self) -> LiveFrame:
        """Advance by one step of 1/60 s and return the state after it."""
        frame = super().advance()
        if self.audit_process is None:
            self.audit_process = AuditProcess()
        if frame.step % AUDIT_EVERY == 0:
            self.audit_process.offer(
                frame.step, frame.positions, self.cloth.face_nodes, self.cloth.weld, self.body()
            )
        return frame

    def wind(self, velocity: tuple[float, float, float] | None, gusts: float = 0.0) -> None:
        """Let the wind blow [m/s], with gusts as a share of its speed; None is a vacuum.

        Raises InputError as `toile.Air` does.
        """
        self.blow(None if velocity is None else Air(velocity=velocity, gusts=gusts).flow())

    def fabric(self, name: str) -> None:
        """Make the cloth of another preset. Raises InputError with the nearest names."""
        self.change_fabric(fabric(name))

    def put(self, name: str, place: npt.ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Put a "ball" or a "table" somewhere [m]. Raises InputError if it would cut the cloth."""
        vertices, faces = surface_of(name)
        self.put_obstacle(name, (vertices + np.asarray(place, np.float64), faces))

    def close(self) -> None:
        """End the audit's process."""
        if self.audit_process is not None:
            self.audit_process.close()
            self.audit_process = None

    def __enter__(self) -> "Live":
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close."""
        self.close()

    @property
    def colours(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """SRGB of cloth and obstacles."""
        return garment_colour(0), BODY


def live(scene: Scene | Sheet, say: Say | None = None) -> Live:
    """Return cloth to play with.

    Parameters
    ----------
    scene
        A `Sheet`, or a scene whose garments are draped first; a body that moves stands as in its first frame.
    say
        Called with sentences about what is draped.

    Raises
    ------
    InputError
        If the scene is at fault, or its garments cannot be put on.
    """
    if isinstance(scene, Sheet):
        return Live(scene.cloth(), scene.obstacles(), StepOptions(), ("sheet",))
    resolved = resolve(scene)
    hung = hang(resolved, None, Listener(say=say))
    if hung.drape.status not in FOLLOWS:
        why = "was cancelled" if hung.drape.failure is None else hung.drape.failure.message
        raise InputError(f"there is nothing to play with: the drape failed ({why})")
    cloth = replace(hung.drape.cloth, velocities=np.zeros_like(hung.drape.cloth.positions))
    body = {"body": (hung.body.vertices, hung.body.faces)}
    names = tuple(garment.name for garment in hung.garments)
    return Live(cloth, body, replace(hung.drape.step, air=resolved.air), names)
