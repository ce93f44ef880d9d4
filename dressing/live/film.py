"""A film of live cloth, as a GLB file whose animation any viewer plays."""

from dataclasses import replace

import numpy as np

from toile.dressing.files.writers.glb import glb_bytes
from toile.dressing.live.live_glb import shown_meshes
from toile.dressing.live.live_scene import Live
from toile.geometry.arrays import Float

FILM_EVERY = 4
"""Steps from one picture of a film to the next: 15 per second."""
LONGEST = 450
"""Pictures in a film at most: 30 s. Of a longer play the last ones are kept."""


class LiveFilm:
    """Places of cloth and obstacles, as many as a film has pictures."""

    def __init__(self, live: Live) -> None:
        self.cloth: list[Float] = []
        self.ways: list[dict[str, Float]] = []
        self.add(live)

    def add(self, live: Live) -> None:
        """Take a picture."""
        self.cloth.append(live.frame.positions.astype(np.float32))
        surfaces = live.obstacles.surfaces(None if live.surface is None else live.surface.vertices)
        self.ways.append({name: vertices[0] for name, (vertices, _) in surfaces.items()})
        del self.cloth[:-LONGEST], self.ways[:-LONGEST]

    def glb(self, live: Live) -> bytes:
        """Return the film; things that were not there all the time stay where they are."""
        cloth, *things = shown_meshes(live)
        node = live.cloth.node
        shapes = [places[node].astype(np.float64) - cloth.positions for places in self.cloth]
        meshes = [replace(cloth, shapes=shapes)]
        for thing in things:
            there = all(thing.name in ways for ways in self.ways)
            way = np.array([ways[thing.name] for ways in self.ways]) - thing.positions[0] if there else None
            meshes.append(replace(thing, way=way))
        times = np.arange(len(self.cloth), dtype=np.float64) * (FILM_EVERY / 60.0)
        return glb_bytes(meshes, times)
