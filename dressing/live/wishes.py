"""What a page asks for, carried out between steps, and noted with them to be played again."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.live.film import FILM_EVERY, LiveFilm
from toile.dressing.live.live_scene import Live, live
from toile.dressing.live.page import live_page
from toile.dressing.live.record import save_play
from toile.dressing.live.sheet import Sheet
from toile.dressing.live.shown import PRESSURE, packed_frame, scene_of, state_of
from toile.dressing.run.scene import Scene
from toile.geometry.errors import InputError

Wish = Mapping[str, Any]
"""What to do (`do`), and with what."""


class Game:
    """Live cloth with what a page may do to it.

    Attributes
    ----------
    live
        The cloth.
    start
        What it began with: a `Sheet`, or a scene.
    running
        Whether steps are made.
    journal
        Wishes with the steps before which they came.
    settings
        What the page shows: wind, gusts, gravity, friction, self-contact, floor, fabric.
    shows
        Values that frames carry: "pressure", or "".
    film
        What is recorded, or None.
    """

    def __init__(self, start: Sheet | Scene) -> None:
        self.start = start
        self.running = True
        self.single = 0
        self.journal: list[tuple[int, dict[str, Any]]] = []
        self.ball_moves = False
        self.shows = ""
        self.film: LiveFilm | None = None
        self._begin()

    def _begin(self) -> None:
        """Make the cloth as it starts."""
        self.live: Live = live(self.start)
        self.settings: dict[str, Any] = {
            "wind": 0.0, "gusts": 0.0, "gravity": 9.81, "self_contact": True, "floor": False,
            "fabric": self.live.cloth.fabrics[0].name, "friction": self.live.cloth.fabrics[0].friction_body,
        }  # fmt: skip
        self._cuts: list[tuple[int, int]] = []
        if self.film is not None:
            self.film = LiveFilm(self.live)
        self._rest = {name: surface[0].copy() for name, surface in self._surfaces().items()}

    def _surfaces(self) -> dict[str, Any]:
        live = self.live
        return dict(live.obstacles.surfaces(None if live.surface is None else live.surface.vertices))

    def carry_out(self, wish: Wish) -> bool:
        """Do what is wished; return whether the scene is another now, which pages must be sent anew.

        Raises InputError if it cannot be done.
        """
        name = str(wish.get("do"))
        act = ACTS.get(name)
        if act is None:
            raise InputError(f"there is nothing called {name!r} to do")
        try:
            anew = act(self, wish)
        except (KeyError, TypeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"{name}: {type(error).__name__}: {error}") from None
        if name not in UNTOLD:
            self.journal.append((self.live.frame.step, dict(wish)))
        return bool(anew)

    def advance(self) -> None:
        """Make a step; the ball goes its own way where it shall."""
        if self.ball_moves and "ball" in self.live.obstacles.names:
            t = self.live.frame.seconds
            # A path about where it was put.
            way = np.array([0.12 * np.sin(1.3 * t), 0.04 * np.sin(1.9 * t), 0.12 * np.sin(0.9 * t)])
            self.live.move_obstacle("ball", self._rest["ball"] + way)
        while self._cuts and self._cuts[0][0] <= self.live.frame.step:
            self.live.unpin(np.array([self._cuts.pop(0)[1]]))
        frame = self.live.advance()
        if self.film is not None and frame.step % FILM_EVERY == 0:
            self.film.add(self.live)

    def offsets(self) -> dict[str, list[float]]:
        """Return how far obstacles are from where they were put [m]."""
        now = self._surfaces()
        return {name: (now[name][0][0] - self._rest[name][0]).tolist() for name in now}

    def rest(self, name: str) -> Any:
        """Return an obstacle where it was put: vertices [m], shape (v, 3), and faces, (t, 3)."""
        return self._rest[name], self._surfaces()[name][1]

    def pull(self, offset: Any) -> None:
        """Lead what is gripped: cloth, or the pin that was."""
        if self._pin is None:
            self.live.pull_to(np.array(offset, np.float64))
        else:
            node, place = self._pin
            self.live.move_pins(np.array([node]), place[None] + np.array(offset, np.float64))

    _pin: Any = None

    def grip(self, node: int) -> None:
        """Grip cloth, or a pin."""
        self._pin = None
        if 0 <= node < len(self.live.pinned) and self.live.pinned[node]:
            self._pin = (node, self.live.stepper.x[node].copy())
        else:
            self.live.grip(node)

    def release(self) -> None:
        """Let go."""
        self._pin = None
        self.live.release()

    def lay_floor(self, on: bool) -> None:
        """Lay a floor below everything, or take it away."""
        self.settings["floor"] = on
        low = min(
            [float(self.live.stepper.x[:, 1].min()), *(float(v[:, 1].min()) for v in self._rest.values())]
        )
        self.live.lay_ground(min(low, -0.35) if on else None)

    def blow(self, wish: Wish) -> None:
        """Turn the wind up or down: a speed [m/s], towards +X and a little to the front."""
        speed, gusts = float(wish["speed"]), float(wish.get("gusts", self.settings["gusts"]))
        self.live.wind((0.9 * speed, 0.0, 0.43 * speed) if speed else None, gusts)
        self.settings |= {"wind": speed, "gusts": gusts}

    def change_fabric(self, name: str) -> None:
        """Make the cloth of another fabric."""
        self.live.fabric(name)
        self.settings |= {"fabric": name, "friction": self.live.cloth.fabrics[0].friction_body}

    def cut(self, seconds: float) -> None:
        """Let the pins go one after another, the last after so many seconds."""
        if not 0.0 <= seconds <= 60.0:
            raise InputError(f"cut: seconds must lie between 0 and 60, got {seconds:g}", field="seconds")
        pins = np.flatnonzero(self.live.pinned).tolist()
        now, way = self.live.frame.step, round(60.0 * seconds)
        self._cuts = [(now + way * (k + 1) // max(len(pins), 1), pin) for k, pin in enumerate(pins)]

    def rub(self, value: float) -> None:
        """Give cloth this friction on all that it touches."""
        if not 0.0 <= value <= 2.0:
            raise InputError(f"friction must lie between 0 and 2, got {value:g}", field="friction")
        own = self.live.cloth.fabrics[0]
        self.live.change_fabric(replace(own, friction_body=value, friction_self=value))
        self.settings["friction"] = value

    def show(self, values: str) -> None:
        """Let frames carry values: "pressure", or ""."""
        self.shows = PRESSURE if values == PRESSURE else ""

    def record(self, on: bool) -> None:
        """Begin a film, or leave it."""
        self.film = LiveFilm(self.live) if on else None

    def change(self, name: str, value: Any) -> None:
        """Change a number of the step."""
        self.live.change_options(**{name: value})
        self.settings[name] = value

    def put(self, wish: Wish) -> bool:
        """Put a ball or a table somewhere, or take it away; the scene is another then."""
        name, place = str(wish["name"]), wish.get("place")
        if place is None:
            self.live.put_obstacle(name, None)
            self._rest.pop(name, None)
            return True
        self.live.put(name, place)
        self._rest[name] = self._surfaces()[name][0].copy()
        return True

    def move(self, wish: Wish) -> None:
        """Move an obstacle from where it was put [m]."""
        name = str(wish["name"])
        self.ball_moves = self.ball_moves and name != "ball"
        self.live.move_obstacle(name, self._rest[name] + np.array(wish["offset"], np.float64))

    def restart(self, wish: Wish) -> bool:
        """Begin anew, with another sheet where the wish says so."""
        given = {
            key: wish[key] for key in ("cells", "side", "fabric", "grain", "pins", "object") if key in wish
        }
        if given:
            self.start = replace(self.start if isinstance(self.start, Sheet) else Sheet(), **given)
        self.live.close()
        self.journal.clear()
        self.running, self._pin = True, None
        self._begin()
        return True

    # What the server asks for.

    def page(self, language: str) -> str:
        """Return the page, in "en" or "es"."""
        return live_page(language)

    def scene(self) -> dict[str, Any]:
        """Return what a page needs to draw frames."""
        return scene_of(self)

    def frame(self) -> bytes:
        """Return the state after the last step, as the page takes it."""
        return packed_frame(self)

    def state(self) -> dict[str, Any]:
        """Return what the page shows as numbers."""
        return state_of(self)

    def save(self, folder: Path) -> list[Path]:
        """Write the shape, the play, and the film if there is one; return the files."""
        return save_play(self, folder)

    def close(self) -> None:
        """End the audit's process."""
        self.live.close()


def _pause(game: Game, wish: Wish) -> None:
    game.running = not bool(wish.get("on", True))


def _step(game: Game, wish: Wish) -> None:
    game.running, game.single = False, game.single + 1


def _self_moving(game: Game, wish: Wish) -> None:
    game.ball_moves = bool(wish["on"])


ACTS: dict[str, Callable[[Game, Wish], object]] = {
    "grip": lambda game, wish: game.grip(int(wish["node"])),
    "pull": lambda game, wish: game.pull(wish["offset"]),
    "release": lambda game, wish: game.release(),
    "pin": lambda game, wish: game.live.pin(np.array([int(wish["node"])])),
    "unpin": lambda game, wish: game.live.unpin(np.array([int(wish["node"])]) if "node" in wish else None),
    "wind": lambda game, wish: game.blow(wish),
    "fabric": lambda game, wish: game.change_fabric(str(wish["name"])),
    "gravity": lambda game, wish: game.change("gravity", float(wish["value"])),
    "friction": lambda game, wish: game.rub(float(wish["value"])),
    "cut": lambda game, wish: game.cut(float(wish["seconds"])),
    "show": lambda game, wish: game.show(str(wish["values"])),
    "record": lambda game, wish: game.record(bool(wish["on"])),
    "self_contact": lambda game, wish: game.change("self_contact", bool(wish["on"])),
    "floor": lambda game, wish: game.lay_floor(bool(wish["on"])),
    "ball_moves": _self_moving,
    "put": lambda game, wish: game.put(wish),
    "move": lambda game, wish: game.move(wish),
    "restart": lambda game, wish: game.restart(wish),
    "pause": _pause,
    "step": _step,
}
"""What a page may ask for."""
UNTOLD = ("restart", "pause", "step", "show", "record")
"""What a journal leaves out: steps count, not seconds."""
