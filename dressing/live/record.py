"""What was played, kept: shapes as GLB, and wishes with their steps, to play the same again."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.live.live_glb import live_glb
from toile.dressing.live.sheet import Sheet

if TYPE_CHECKING:
    from toile.dressing.live.wishes import Game

VERSION = 1


def save_play(game: "Game", folder: Path, name: str = "live") -> list[Path]:
    """Write NAME.glb, the shape now, and NAME.json, which `toile live` plays again; return their paths.

    Only plays that began with a sheet can be played again. What is recorded becomes NAME-film.glb.
    """
    written = [write_atomic(folder / f"{name}.glb", live_glb(game.live))]
    if isinstance(game.start, Sheet):
        kept = {
            "toile_live": VERSION, "sheet": vars(game.start), "steps": game.live.frame.step,
            "wishes": [[step, wish] for step, wish in game.journal],
        }  # fmt: skip
        written.append(write_atomic(folder / f"{name}.json", (json.dumps(kept, indent=1) + "\n").encode()))
    if game.film is not None:
        written.append(write_atomic(folder / f"{name}-film.glb", game.film.glb(game.live)))
    return written
