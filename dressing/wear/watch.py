"""What no drape may come to: cloth that grows beyond reason, and garments that fall off the body."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from toile.dressing.body.place import ROOM, Place
from toile.dressing.wear.drape_types import Failure, StrainedPlace
from toile.dressing.wear.fault import Panelled
from toile.dressing.wear.strain import warp_weft_strain
from toile.engine.cloth.cloth import Cloth
from toile.engine.drape.plan import Frame
from toile.geometry.arrays import Bool, Float
from toile.geometry.normals import area_normals

GROWN, GROWN_AT_END = 3.0, 1.5
"""Area of a garment over what was cut at which a drape is stopped; at which it has failed in the end."""
TORN_AT_END = 10.0
"""Largest strain at the end from which cloth has left the range of any fabric: 1000 %."""
STRAINED = 0.5
"""Strain from which a place is named in the report."""
NAMED = 8
"""Places that are named at most."""
FALLEN = 0.3
"""A garment has fallen whose top has come down by this [m], and no longer lies on the body."""
ON_BODY = 0.05
"""Distance from the body's vertices at which cloth counts as lying on it [m]."""
FEET = 0.12
"""Lower part of the body that holds up no garment, as a share of its height."""
LOW = 0.25
"""Height of its top, as a share of the body's, from which a garment that came down has fallen to the feet."""
FRAMES_DOWN = 5
"""Frames after which a garment that has fallen may have come to rest."""
TOP = 0.98
"""Quantile of heights that is a garment's top: a lone corner is none."""


class Watch:
    """Looks at the frames of a drape of garments on a body, vertices (v, 3) [m], that stands in a place.

    Attributes
    ----------
    failure
        Why the drape must stop, or None.
    """

    def __init__(self, body: Float, garments: Sequence[Panelled], place: Place = ROOM) -> None:
        self.failure: Failure | None = None
        self._place = place
        self._garments = garments
        low, height = float(body[:, 1].min()), float(np.ptp(body[:, 1]))
        self._low = low + LOW * height
        self._body = cKDTree(body[body[:, 1] >= low + FEET * height])
        self._top = np.full(len(garments), -np.inf)
        self._down = np.zeros(len(garments), int)

    def see(self, frame: Frame) -> bool:
        """Look at a frame; return whether the drape may continue."""
        cloth = frame.cloth
        areas = area_ratios(cloth, len(self._garments))
        worst = int(np.nanargmax(areas))
        if not areas[worst] < GROWN:
            self.failure = self._grown(cloth, worst, float(areas[worst]), f"frame {frame.index}")
        elif frame.phase != "sewing":
            self._see_heights(cloth, frame.index)
        return self.failure is None

    def at_end(self, cloth: Cloth) -> Failure | None:
        """Return what is beyond reason about the cloth of a drape that has come to its end, or None."""
        areas = area_ratios(cloth, len(self._garments))
        worst = int(np.nanargmax(areas))
        if areas[worst] >= GROWN_AT_END:
            return self._grown(cloth, worst, float(areas[worst]), "at the end")
        places = strained_places(cloth, self._garments, self._place)
        if places and places[0].percent >= 100.0 * TORN_AT_END:
            return Failure(
                kind="overstretched",
                message=f"cloth is stretched by {places[0].percent:.0f} %, which no fabric bears; the "
                "garment is too small there, or caught",
                where=places[0].where,
            )
        for index in np.flatnonzero(self._down > 0).tolist():
            return self._fallen(cloth, index, "at the end")
        return None

    def _see_heights(self, cloth: Cloth, frame: int) -> None:
        """Note which garments have come down, and off the body."""
        for index in range(len(self._garments)):
            nodes = np.unique(cloth.node[cloth.faces[cloth.garment == index]])
            if cloth.pinned[nodes].any():
                continue
            own = cloth.positions[nodes]
            top = float(np.quantile(own[:, 1], TOP))
            self._top[index] = max(self._top[index], top)
            down = top < self._top[index] - FALLEN
            if down and top >= self._low:
                down = _is_away(own, self._body)
            self._down[index] = self._down[index] + 1 if down else 0
            if self._down[index] >= FRAMES_DOWN:
                self.failure = self._fallen(cloth, index, f"frame {frame}")

    def _fallen(self, cloth: Cloth, index: int, when: str) -> Failure:
        nodes = np.unique(cloth.node[cloth.faces[cloth.garment == index]])
        top = float(np.quantile(cloth.positions[nodes, 1], TOP))
        return Failure(
            kind="fell_off",
            message=f"the garment fell off the body: its top came down by {self._top[index] - top:.2f} m; it "
            "is too wide to hold, or starts beside the body (narrow its waist, or pin an edge)",
            where=f"garment {self._garments[index].name}, {when}",
        )

    def _grown(self, cloth: Cloth, index: int, ratio: float, when: str) -> Failure:
        """Return the failure of a garment whose area has grown, with the panel that grew the most."""
        own = cloth.garment == index
        now, rest = (np.bincount(cloth.panel[own], area[own]) for area in (_areas(cloth), cloth.rest_area))
        panel = int(np.argmax(now / np.maximum(rest, 1e-300)))
        there = own & (cloth.panel == panel)
        x, y, z = self._place.outward(cloth.positions[cloth.face_nodes[there]].mean(axis=(0, 1)))
        return Failure(
            kind="overstretched",
            message=f"the cloth has grown to {ratio:.3g} times what was cut; the garment is too small for "
            "this body, does not lie around it, or is no cloth there",
            where=f"garment {self._garments[index].name}: {self._garments[index].panel_names[panel]}, near "
            f"({x:.2f}, {y:.2f}, {z:.2f}) m, {when}",
        )


def is_off(nodes: Float, top: float, skin: Float) -> bool:
    """Whether nodes of a garment [m], (n, 3), have come down from their top, and off a skin, (v, 3)."""
    down = float(np.quantile(nodes[:, 1], TOP)) < top - FALLEN
    return down and _is_away(nodes, cKDTree(skin))


def area_ratios(cloth: Cloth, count: int) -> Float:
    """Area of every garment over its rest area, shape (count,)."""
    return garment_areas(cloth, count) / np.bincount(cloth.garment, cloth.rest_area, count)


def garment_areas(cloth: Cloth, count: int) -> Float:
    """Area of every garment as it is [m^2], shape (count,)."""
    return np.asarray(np.bincount(cloth.garment, _areas(cloth), count))


def strained_places(
    cloth: Cloth, garments: Sequence[Panelled], place: Place = ROOM, beyond: float = STRAINED
) -> tuple[StrainedPlace, ...]:
    """Return the panels where cloth is stretched by more than `beyond`, the most first, at most NAMED."""
    strain = warp_weft_strain(cloth).max(axis=1)
    found = []
    for index, garment in enumerate(garments):
        for panel, name in enumerate(garment.panel_names):
            own: Bool = (cloth.garment == index) & (cloth.panel == panel)
            if not own.any() or strain[own].max() <= beyond:
                continue
            face = int(np.flatnonzero(own)[strain[own].argmax()])
            x, y, z = place.outward(cloth.positions[cloth.face_nodes[face]].mean(axis=0))
            found.append(
                StrainedPlace(
                    percent=100.0 * float(strain[face]),
                    faces=int(np.count_nonzero(strain[own] > beyond)),
                    where=f"garment {garment.name}: {name}, near ({x:.2f}, {y:.2f}, {z:.2f}) m",
                )
            )
    return tuple(sorted(found, key=lambda one: -one.percent)[:NAMED])


def _is_away(nodes: Float, body: cKDTree) -> bool:
    """Whether no node [m], shape (n, 3), lies on a body."""
    return bool(np.min(body.query(nodes, distance_upper_bound=ON_BODY)[0]) > ON_BODY)


def _areas(cloth: Cloth) -> Float:
    return np.asarray(0.5 * np.linalg.norm(area_normals(cloth.positions[cloth.face_nodes]), axis=1))
