"""What was played, kept: shapes as GLB, and wishes with their steps, to play the same again."""

import json
from pathlib import Path
from typing import Any

from toile.dressing.files.palette import linear
from toile.dressing.files.parse_text import parse_json
from toile.dressing.files.writers.atomic import write_atomic
from toile.dressing.files.writers.glb import GlbMesh, glb_bytes
from toile.dressing.live.live_scene import Live
from toile.dressing.live.sheet import Sheet
from toile.dressing.live.wishes import Game
from toile.geometry.errors import InputError
from toile.geometry.normals import drawn_normals

VERSION = 1


def save_play(game: Game, folder: Path, name: str = "live") -> list[Path]:
    """Write NAME.glb, the shape now, and NAME.json, which `toile live` plays again; return their paths.

    Only plays that began with a sheet can be played again.
    """
    written = [write_atomic(folder / f"{name}.glb", live_glb(game.live))]
    if isinstance(game.start, Sheet):
        kept = {
            "toile_live": VERSION, "sheet": vars(game.start), "steps": game.live.frame.step,
            "wishes": [[step, wish] for step, wish in game.journal],
        }  # fmt: skip
        written.append(write_atomic(folder / f"{name}.json", (json.dumps(kept, indent=1) + "\n").encode()))
    return written


def live_glb(live: Live) -> bytes:
    """Return the cloth and its obstacles as they are, as a GLB file."""
    cloth_colour, body_colour = live.colours
    x, faces = live.frame.positions, live.cloth.face_nodes
    node = live.cloth.node
    meshes = [
        GlbMesh(
            name=" and ".join(live.names), positions=x[node], normals=drawn_normals(x, faces)[node],
            faces=live.cloth.faces, colour=linear(cloth_colour), uv=live.cloth.uv, double_sided=True,
        )
    ]  # fmt: skip
    surfaces = live.obstacles.surfaces(None if live.surface is None else live.surface.vertices)
    meshes += [
        GlbMesh(
            name=name, positions=vertices, normals=drawn_normals(vertices, triangles), faces=triangles,
            colour=linear(body_colour),
        )
        for name, (vertices, triangles) in surfaces.items()
    ]  # fmt: skip
    return glb_bytes(meshes)


def replayed(path: Path) -> Game:
    """Return the play of a file that `save_play` wrote, at its last step, with the bytes it had then.

    Raises InputError if the file is none.
    """
    try:
        kept: dict[str, Any] = parse_json(path.read_text(encoding="utf-8"))
        if kept["toile_live"] != VERSION:
            raise ValueError(f"version {kept['toile_live']}")
        game, steps = Game(Sheet(**kept["sheet"])), int(kept["steps"])
        wishes = [(int(step), dict(wish)) for step, wish in kept["wishes"]]
    except (OSError, ValueError, LookupError, TypeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: is no play that toile live saved ({error})", file=path) from None
    for step in range(steps):
        while wishes and wishes[0][0] <= step:
            game.carry_out(wishes.pop(0)[1])
        game.advance()
    for _, wish in wishes:
        game.carry_out(wish)
    return game
