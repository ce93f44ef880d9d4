"""Descriptions of crossing triangles: garment, panels, faces as their file counts them, coordinates."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from toile.collide.audit import Crossings
from toile.dressing.body.place import ROOM, Place
from toile.engine.cloth.cloth import Cloth
from toile.geometry.arrays import Int

NAMED = 8
"""Faces that a message names at most."""


class Panelled(Protocol):
    """A garment as a message names it, with the names of its panels."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def panel_names(self) -> tuple[str, ...]:
        """Names of its panels, by their numbers."""


def faces_at_fault(cloth: Cloth, crossings: Crossings) -> tuple[Int, ...]:
    """Return the faces that cross, by their numbers in the file of each garment, where they have any."""
    if cloth.origin is None:
        return ()
    bad = _crossing_faces(crossings)
    numbers, owner = cloth.origin.face[bad], cloth.garment[bad]
    count = len(cloth.origin.first) - 1
    return tuple(np.unique(numbers[(owner == index) & (numbers >= 0)]) for index in range(count))


def place_of(cloth: Cloth, crossings: Crossings, garments: Sequence[Panelled], place: Place = ROOM) -> str:
    """Say in words where cloth crosses: the panels of every garment, faces of its file if known, coordinates.

    Coordinates are those of the middle of the crossing faces [m], Y up, in the room where the body stands in
    that place.
    """
    bad = _crossing_faces(crossings)
    numbers = faces_at_fault(cloth, crossings) or (np.empty(0, np.int32),) * len(garments)
    said = []
    for index, (garment, faces) in enumerate(zip(garments, numbers, strict=False)):
        own = bad[cloth.garment[bad] == index]
        if not len(own):
            continue
        panels = ", ".join(garment.panel_names[panel] for panel in np.unique(cloth.panel[own]).tolist())
        words = f"garment {garment.name}: {panels}"
        if len(faces):
            more = f" and {len(faces) - NAMED} more" if len(faces) > NAMED else ""
            words += f", faces {', '.join(map(str, faces[:NAMED].tolist()))}{more} of its file"
        said.append(words)
    x, y, z = place.outward(cloth.positions[cloth.face_nodes[bad]].mean(axis=(0, 1)))
    return "; ".join([*said, f"near ({x:.2f}, {y:.2f}, {z:.2f}) m"])


def _crossing_faces(crossings: Crossings) -> Int:
    """Faces of the cloth that cross anything, each once, shape (k,)."""
    return np.unique(np.concatenate([crossings.avatar[:, 0], crossings.cloth.ravel()]))
