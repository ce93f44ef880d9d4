"""What a page of live cloth is sent: its scene, frames and numbers."""

import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from toile.dressing.live.sheet import Sheet

if TYPE_CHECKING:
    from toile.dressing.live.wishes import Game

PRESSURE = "pressure"
"""What frames carry a value per node of, where a page asks for it."""


def packed_frame(game: "Game") -> bytes:
    """Return a frame: step, how many floats obstacles and values have, these, positions; all float32."""
    offsets = [part for offset in game.offsets().values() for part in offset]
    frame = game.live.frame
    values = game.live.pressure() if game.shows == PRESSURE else np.empty(0)
    floats = np.concatenate([np.array(offsets, np.float64), values, frame.positions.ravel()])
    return struct.pack("<III", frame.step, len(offsets), len(values)) + floats.astype("<f4").tobytes()


def scene_of(game: "Game") -> dict[str, Any]:
    """Return what a page needs to draw frames."""
    live = game.live
    cloth, body = live.colours
    uv = np.zeros((len(live.frame.positions), 2))
    uv[live.cloth.node] = live.cloth.uv
    return {
        "cloth": {
            "faces": live.cloth.face_nodes.ravel().tolist(), "count": len(live.frame.positions),
            "colour": cloth, "uv": np.round(uv, 5).ravel().tolist(),
        },
        "corners": np.round(live.cloth.rest_corners, 6).ravel().tolist(),
        "obstacles": [
            {
                "name": name, "colour": body, "faces": game.rest(name)[1].ravel().tolist(),
                "positions": np.round(game.rest(name)[0], 5).ravel().tolist(),
            }
            for name in live.obstacles.names
        ],
        "sheet": vars(game.start) if isinstance(game.start, Sheet) else None,
    }  # fmt: skip


def state_of(game: "Game") -> dict[str, Any]:
    """Return what a page shows as numbers."""
    live = game.live
    frame, audits = live.frame, live.audit_process
    last = None if audits is None or audits.last is None else audits.last
    return {
        "step": frame.step,
        "seconds": round(frame.seconds, 3),
        "stretch": round(100.0 * frame.stretch, 2),
        "contacts": frame.contacts,
        "held_back": frame.held_back,
        "crossings": None if last is None else last.body + last.cloth,
        "audits": 0 if audits is None else audits.audits,
        "pinned": np.flatnonzero(live.pinned).tolist(),
        "settings": game.settings,
        "holds": live.hand.holds,
        "floor": live.ground,
        "recording": game.film is not None,
    }
