"""A saved play, played again."""

from pathlib import Path
from typing import Any

from toile.dressing.files.parse_text import parse_json
from toile.dressing.live.record import VERSION
from toile.dressing.live.sheet import Sheet
from toile.dressing.live.wishes import Game
from toile.geometry.errors import InputError


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
