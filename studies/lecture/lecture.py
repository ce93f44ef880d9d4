"""A lecture that runs: two teaching cloths, changed by a page, served as live cloth is."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from toile.dressing.live.sheet import surface_of
from toile.dressing.view.view_page import static
from toile.dressing.weave.read_weave import read_weave
from toile.dressing.weave.weave_picture import weave_svg
from toile.engine.live.live_cloth import STEP
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError
from toile.studies.lecture.lessons import COMPARE, STEPS, Lesson
from toile.studies.lecture.setup import Setup
from toile.studies.lecture.teaching_cloth import TeachingCloth

STATIC = Path(__file__).resolve().parent / "static"
WEAVE = {
    "warp": "cotton:20tex", "weft": "cotton:20tex", "weave": "plain", "ends_per_cm": 26, "picks_per_cm": 24
}  # fmt: skip
"""The weave of the last step, at first."""
WEAVES = ("plain", "twill", "2/1", "3/1", "satin")


class Lecture:
    """What runs: left and right, and what their errors are measured against.

    Attributes
    ----------
    lessons
        Its steps.
    at
        Which step.
    panes
        Left and right.
    weave
        The weave of the last step, as a scene file says it.
    """

    def __init__(self, lessons: Sequence[Lesson] = STEPS) -> None:
        self.lessons = lessons
        self.running = True
        self.single = 0
        self.weave: dict[str, Any] = dict(WEAVE)
        self.picture = ""
        self.turn_to(0)

    def turn_to(self, at: int) -> None:
        """Go to a step of the lecture. Raises InputError if there is none of that number."""
        if not 0 <= at < len(self.lessons):
            raise InputError(f"there is no step {at}; they go from 0 to {len(self.lessons) - 1}", field="at")
        self.at = at
        self.setups = list(self.lessons[at].panes)
        if self.lessons[at].name == "yarns":
            self.weave_cloth({})
        self.restart()

    def restart(self) -> None:
        """Begin anew with the setups as they are."""
        self.seconds = 0.0
        self.panes = [TeachingCloth(setup) for setup in self.setups]
        self._match()
        self._held: Float | None = None
        self._from = self._offset = np.zeros(3)

    def _match(self) -> None:
        """Make what errors are measured against; one for both, where only their integrators differ."""
        self.twins: list[TeachingCloth | None] = [None, None]
        if "error" not in self.lessons[self.at].curves:
            return
        left, right = self.panes
        alike = replace(left.setup, method=right.setup.method, step=right.setup.step) == right.setup
        # Both must be where the other is, too: at the start.
        shared = alike and left.seconds == right.seconds == 0.0
        first = left.twin()
        self.twins = [first, first if shared else right.twin()]

    def change(self, wish: Mapping[str, Any]) -> None:
        """Change a number of one pane, or of both."""
        name, value, pane = str(wish["name"]), wish["value"], wish.get("pane")
        lesson = self.lessons[self.at]
        if name not in (lesson.controls if pane is None else lesson.own):
            raise InputError(f"{name} cannot be changed here", field=name)
        which = (0, 1) if pane is None else (int(pane),)
        changed = [replace(self.setups[k], **{name: value}) for k in which]
        for k, setup in zip(which, changed, strict=True):
            self.setups[k] = setup
        self.panes = [
            pane.changed(self.setups[k]) if k in which else pane for k, pane in enumerate(self.panes)
        ]
        if any(self.panes[k].seconds != self.seconds for k in which) and name in ("cells", "pins", "model"):
            self.restart()
            return
        self.seconds = max(pane.seconds for pane in self.panes)
        self._match()

    def weave_cloth(self, wish: Mapping[str, Any]) -> None:
        """Weave the cloth of the right pane. Raises InputError where yarns do not fit."""
        weave = self.weave | {key: wish[key] for key in WEAVE if key in wish}
        cloth = read_weave(weave)
        self.weave, self.picture = weave, weave_svg(cloth)
        self.setups[1] = replace(self.setups[1], fabric=cloth.fabric("woven"))

    # What the server asks for.

    def advance(self) -> None:
        """Go on by 1/60 s."""
        self.seconds += STEP
        for cloth in self._all():
            if self._held is not None:
                cloth.pull(cloth.node_at(self._held), self._from + self._offset)
            cloth.advance(self.seconds, exactly=cloth in self.twins)

    def _all(self) -> list[TeachingCloth]:
        """Return both panes and what errors are measured against."""
        return list(dict.fromkeys([*self.panes, *(twin for twin in self.twins if twin is not None)]))

    def carry_out(self, wish: Mapping[str, Any]) -> bool:
        """Do what is wished; return whether the scene is another now. Raises InputError."""
        name = str(wish.get("do"))
        if name not in ACTS:
            raise InputError(f"there is nothing called {name!r} to do")
        before = [id(pane) for pane in self.panes]
        try:
            ACTS[name](self, wish)
        except (KeyError, TypeError, ValueError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"{name}: {type(error).__name__}: {error}") from None
        return before != [id(pane) for pane in self.panes]

    def grip(self, pane: int, node: int) -> None:
        """Take hold of a pane's node, and of the same place of the other."""
        if pane not in (0, 1):
            raise InputError(f"there is no pane {pane}", field="pane")
        self._held = self.panes[pane].pattern_place(node)
        self._from, self._offset = self.panes[pane].x[node].copy(), np.zeros(3)

    def pull(self, offset: Any) -> None:
        """Pull what is held so far from where it was [m]."""
        self._offset = np.array(offset, np.float64).reshape(3)

    def release(self) -> None:
        """Let go."""
        self._held = None
        for cloth in self._all():
            cloth.release()

    def page(self, language: str) -> str:
        """Return the page, in "en" or "es"."""
        own = {name: (STATIC / name).read_text(encoding="utf-8") for name in NAMES}
        page = own["lecture.html"].replace("LANGUAGE", language)
        scripts = [static("stage.js"), *(own[name] for name in NAMES if name.endswith(".js"))]
        for mark, content in (
            ("STYLE", static("viewer.css") + own["lecture.css"]), ("SCRIPTS", "\n".join(scripts)),
            ("WEAVES", "".join(f"<option>{escape(name)}</option>" for name in WEAVES)),
            ("LESSONS", json.dumps([lesson.name for lesson in self.lessons])),
        ):  # fmt: skip
            page = page.replace(f"<!--{mark}-->", content).replace(f"/*{mark}*/", content)
        return page

    def scene(self) -> dict[str, Any]:
        """Return what a page needs to draw frames."""
        lesson = self.lessons[self.at]
        ball = surface_of("ball")
        return {
            "at": self.at, "name": lesson.name, "controls": lesson.controls, "own": lesson.own,
            "curves": lesson.curves, "picture": self.picture if lesson.name == "yarns" else "",
            "weave": self.weave,
            "panes": [
                {
                    "version": pane.version, "count": len(pane.x), "faces": pane.faces.ravel().tolist(),
                    "pairs": pane.pairs.ravel().tolist(), "kinds": pane.kinds().tolist(),
                    "setup": _plain(pane.setup),
                    "ball": {
                        "faces": ball[1].ravel().tolist(), "positions": np.round(ball[0], 5).ravel().tolist()
                    } if pane.setup.ball else None,
                }
                for pane in self.panes
            ],
        }  # fmt: skip

    def frame(self) -> bytes:
        """Return the time, then for each pane: version, nodes, corners, energies, error; all float32.

        Its positions follow, and the faces of a pane whose mesh changes.
        """
        parts = [np.array([self.seconds])]
        for pane, twin in zip(self.panes, self.twins, strict=True):
            error = np.nan if twin is None else pane.distance(twin)
            faces = pane.faces.ravel() if pane.setup.model == "adaptive" else np.empty(0)
            head = [pane.version, len(pane.x), len(faces), *pane.energies(), error]
            parts += [np.array(head), pane.x.ravel(), faces]
        return np.concatenate(parts).astype("<f4").tobytes()

    def state(self) -> dict[str, Any]:
        """Return what the page shows as numbers."""
        return {
            "seconds": round(self.seconds, 3),
            "panes": [
                {
                    "exploded": pane.exploded, "nodes": len(pane.x), "faces": len(pane.faces),
                    "limit": pane.limit if np.isfinite(pane.limit) else None,
                }
                for pane in self.panes
            ],
        }  # fmt: skip

    def save(self, folder: Path) -> list[Path]:
        """Raise InputError: a lecture is not saved."""
        raise InputError("a lecture is not saved; use toile live to save what you play")

    def close(self) -> None:
        """Nothing belongs to it."""


def compared() -> Lecture:
    """Return two cloths side by side, and nothing else."""
    return Lecture((COMPARE,))


def _plain(setup: Setup) -> dict[str, Any]:
    """Return a setup as JSON takes it."""
    return {key: value for key, value in vars(setup).items() if key != "fabric"}


def _pause(lecture: Lecture, wish: Mapping[str, Any]) -> None:
    lecture.running = not bool(wish.get("on", True))


def _step(lecture: Lecture, wish: Mapping[str, Any]) -> None:
    lecture.running, lecture.single = False, lecture.single + 1


def _weave(lecture: Lecture, wish: Mapping[str, Any]) -> None:
    lecture.weave_cloth(wish)
    lecture.restart()


NAMES = ("lecture.html", "lecture.css", "lessons.js", "curves.js", "lecture.js")
"""Files of the page."""
ACTS: dict[str, Callable[[Lecture, Mapping[str, Any]], None]] = {
    "turn": lambda lecture, wish: lecture.turn_to(int(wish["at"])),
    "set": lambda lecture, wish: lecture.change(wish),
    "weave": _weave,
    "restart": lambda lecture, wish: lecture.restart(),
    "grip": lambda lecture, wish: lecture.grip(int(wish["pane"]), int(wish["node"])),
    "pull": lambda lecture, wish: lecture.pull(wish["offset"]),
    "release": lambda lecture, wish: lecture.release(),
    "pause": _pause,
    "step": _step,
}
"""What a page may ask for."""
