"""The command `toile live`."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toile.dressing.cli.parser import DONE, Commands, Parser
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.dressing.live.wishes import Game
    from toile.studies.lecture.lecture import Lecture

LEARN = ("lecture", "compare")
"""Pages to learn from."""


def add_live(commands: "Commands[Parser]") -> None:
    """Add the live command."""
    live = commands.add_parser(
        "live",
        help="play with cloth or a dressed body in the browser",
        description="Serve a page on this machine (127.0.0.1 only, with a token in its address) on which "
        "cloth is pulled, pinned and blown at. 'toile live lecture' shows how cloth is simulated, in eight "
        "steps with cloth that moves; 'toile live compare' two models or integrators side by side. It ends "
        "with Ctrl-C or the page's button. Needs the extra: pip install 'toile[live]'.",
    )
    live.add_argument(
        "scene",
        nargs="?",
        type=Path,
        metavar="SCENE.toml|PLAY.json|lecture|compare",
        help="scene, a saved play, or a page to learn from",
    )
    live.add_argument("--cloth", type=int, metavar="N", help="a sheet of N x N cells, 2 to 100 (default: 50)")
    live.add_argument(
        "--garment", metavar="NAME|FILE", help="this garment on the mannequin, at quality preview"
    )
    live.add_argument("--fabric", metavar="NAME", help="fabric preset (see: toile fabrics)")
    live.add_argument(
        "--pins", metavar="WORD", help="of a sheet: none, corners, 'one edge', 'two edges', 'four edges'"
    )
    live.add_argument("--object", metavar="WORD", help="under a sheet: ball, table or none")
    live.add_argument(
        "--port", type=int, default=0, metavar="N", help="port to listen on (default: a free one)"
    )
    live.add_argument("--language", choices=("en", "es"), default="en", help="language of the page")
    live.add_argument("--no-open", action="store_true", help="only print the address")
    live.set_defaults(run=_run_live)


def _run_live(options: argparse.Namespace) -> int:
    """Serve until it is ended."""
    import webbrowser

    from toile.dressing.live.server import LiveServer

    server: LiveServer[Any] = LiveServer(_played(options), options.port, options.language)
    print(f"open {server.url}  (Ctrl-C ends)", flush=True)
    opened = None if options.no_open else lambda: webbrowser.open(server.url)
    try:
        server.run(None if opened is None else lambda: (opened(), None)[1])
    except KeyboardInterrupt:
        print("ended")
    return DONE


def _played(options: argparse.Namespace) -> "Game | Lecture":
    """Return what to play with, or the page to learn from."""
    if options.scene is None or str(options.scene) not in LEARN:
        return _game(options)
    given: list[str] = [
        f"--{name}" for name in ("cloth", "garment", "fabric", "pins", "object")
        if getattr(options, name) is not None
    ]  # fmt: skip
    if given:
        raise InputError(f"{given[0]} does not apply to toile live {options.scene}", field=given[0])
    from toile.studies.lecture.lecture import Lecture, compared

    return Lecture() if str(options.scene) == "lecture" else compared()


def _game(options: argparse.Namespace) -> "Game":
    """Return what to play with."""
    from toile.dressing.live.replay import replayed
    from toile.dressing.live.sheet import Sheet
    from toile.dressing.live.wishes import Game
    from toile.dressing.run.scene import Garment, Scene
    from toile.dressing.run.scene_file import load_scene

    given = [name for name in ("scene", "cloth", "garment") if getattr(options, name) is not None]
    if len(given) > 1:
        raise InputError(f"give one of SCENE.toml, --cloth and --garment, not {' and '.join(given)}")
    if options.scene is not None:
        return replayed(options.scene) if options.scene.suffix == ".json" else Game(load_scene(options.scene))
    if options.garment is not None:
        return Game(Scene(garments=[Garment(options.garment, fabric=options.fabric)], quality="preview"))
    sheet = {"cells": options.cloth, "fabric": options.fabric, "pins": options.pins, "object": options.object}
    return Game(Sheet(**{name: value for name, value in sheet.items() if value is not None}))
