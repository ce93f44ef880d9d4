"""The skin of a moving avatar, of which steps see the part that cloth may come to."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from toile.collide.avatar_surface import AvatarSurface
from toile.collide.cover import Cover
from toile.geometry.arrays import Float, Int
from toile.geometry.cells import Cells
from toile.geometry.face_boxes import swept_face_boxes

ROAM = 0.07
"""How far a node may be from where it drifts before the part near cloth is chosen anew [m]."""
RINGS = 3
"""Rings of cells around the way of the cloth in which skin is near: wider than ROAM and a contact radius."""
BULGE = 0.3
"""How far the way of a vertex within a frame leaves its chord at most, as a share of it."""
SHARES = (0.25, 0.5, 0.75)
"""Shares of the time after which it is looked how far vertices are from their chords."""


class NearSkin(NamedTuple):
    """The part of a skin near cloth.

    Attributes
    ----------
    surface
        As it is, with what it is bound for.
    roam
        Where nodes may be and meet nothing else.
    longest_way
        How far the fastest of its vertices is to go [m].
    """

    surface: AvatarSurface
    roam: Cover
    longest_way: float


class AvatarSkin:
    """The whole skin of an avatar, and the part near cloth.

    Attributes
    ----------
    vertices
        As cloth met them last, in `whole` [m], shape (v, 3).
    faces
        Shape (t, 3).
    part
        Vertices near cloth, shape (k,).
    surface
        Their surface, which moves step by step, or None before the first `focus`.
    """

    def __init__(self, vertices: Float, faces: Int) -> None:
        self.vertices, self.faces = vertices.copy(), faces
        self.part: Int = np.arange(len(vertices), dtype=np.int32)
        self.surface: AvatarSurface | None = None
        self._roam: Cover | None = None

    def focus(
        self, cloth: tuple[Float, Int], drift: Float, end: Float, way: Callable[[float, Int], Float]
    ) -> NearSkin:  # fmt: skip
        """Choose the part near cloth on the way ahead.

        Parameters
        ----------
        cloth
            Nodes [m], shape (n, 3), and faces, (t, 3).
        drift
            How far nodes will move, about [m], shape (n, 3).
        end
            Where the avatar's vertices will be then [m], shape (v, 3).
        way
            Returns where some of them, shape (k,), are after a share of the time [m], shape (k, 3).
        """
        nodes, faces = cloth
        near = Cells.of(swept_face_boxes([nodes, nodes + drift], faces)).grown(RINGS)
        boxes = swept_face_boxes([self.vertices, end], self.faces)
        bulge = BULGE * np.linalg.norm(end - self.vertices, axis=1)[self.faces].max(axis=1)[:, None]
        boxes += np.concatenate([-bulge, bulge], axis=1).repeat(3, axis=1)
        chosen = self.faces[near.boxes_within(boxes)]
        if not len(chosen):
            # One face, which is nowhere near, stands for none.
            chosen = self.faces[:1]
        self.part, corners = np.unique(chosen, return_inverse=True)
        self.surface = AvatarSurface(
            self.vertices[self.part], np.ascontiguousarray(corners.reshape(-1, 3), np.int32), self.part
        )
        start, chord = self.surface.vertices, end[self.part] - self.vertices[self.part]
        self.surface.bound_for = start + chord
        for share in SHARES:
            off = way(share, self.part) - start - share * chord
            np.maximum(self.surface.off_course, np.linalg.norm(off, axis=1), out=self.surface.off_course)
        self._roam = Cover(nodes.copy(), np.full(len(nodes), ROAM), drift)
        longest = float(np.linalg.norm(chord, axis=1).max())
        return NearSkin(self.surface, self._roam, longest)

    def reaches(self, nodes: Float) -> bool:
        """Whether nodes [m], shape (n, 3), meet no more than the part near cloth on their way there."""
        return self._roam is not None and bool((self._roam.allowance(nodes) > 0.0).all())

    def whole(self, pose: Float) -> Float:
        """Return the skin as cloth met it [m], shape (v, 3), where all else is in a pose; and keep it."""
        self.vertices = pose.copy()
        if self.surface is not None:
            self.vertices[self.part] = self.surface.vertices
        return self.vertices
