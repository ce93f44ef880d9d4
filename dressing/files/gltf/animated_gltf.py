"""Reads the motion of a glTF file: what an animation does to the vertices, at regular times."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from toile.dressing.files.corner_surface import Surface
from toile.dressing.files.gltf.gltf_clip import STAND_STILL, Clip, read_clip
from toile.dressing.files.gltf.gltf_file import GltfFile, checked_shape
from toile.dressing.files.gltf.gltf_pieces import gltf_pieces
from toile.dressing.files.gltf.gltf_scene import GltfScene
from toile.dressing.files.gltf.still_gltf import surface_of_pieces
from toile.geometry.arrays import Float

STILL = 1e-6
"""Motion below this share of the size of the body is none: positions are single precision."""
MOST_FRAMES = 100_000


@dataclass(frozen=True, kw_only=True)
class SampledGltf:
    """Vertices over time in file units, shape (k, v, 3), their first surface, and a note on the clip."""

    frames: Float
    surface: Surface
    note: str


def read_animated_gltf(path: Path, fps: float, clip: str | None = None) -> SampledGltf:
    """Return all triangles of the default scene, from the first to the last key of an animation.

    `clip` names the animation; None takes the first. Vertices that no triangle uses are dropped. Raises
    InputError naming what is broken, unsupported or missing, and what to do.
    """
    with checked_shape(path):
        file = GltfFile(path)
        animation = read_clip(file, clip)
        times = _times(file, animation, fps)
        # Double precision: far from the origin, single would move vertices by more than cloth can tell.
        pieces = [
            piece
            for piece in gltf_pieces(GltfScene(file, times, animation.channels), np.float64)
            if len(piece.faces)
        ]
        surface = surface_of_pieces(pieces)
        used, corners = np.unique(surface.faces, return_inverse=True)
        frames = np.concatenate([piece.frames for piece in pieces], axis=1)[:, used].astype(np.float64)
        size = np.ptp(frames[0], axis=0).max()
        if not max(np.abs(frame - frames[0]).max() for frame in frames[1:]) > STILL * size:
            raise file.error(f"{animation.title} moves no vertex", STAND_STILL)
        note = animation.note(f"of {times[-1] - times[0]:.3g} s was read")
        faces = corners.reshape(-1, 3).astype(np.int32)
        surface = replace(surface, positions=frames[0].copy(), faces=faces, uv_faces=np.full_like(faces, -1))
        return SampledGltf(frames=frames, surface=surface, note=note)


def _times(file: GltfFile, clip: Clip, fps: float) -> Float:
    """Return the times of the frames [s]."""
    seconds = clip.end - clip.start
    if seconds <= 0.0:
        raise file.error(f"{clip.title} has only one key and thus no motion", STAND_STILL)
    # Keys are single precision: the last may lie a hair before its frame.
    count = seconds * fps + 1e-3
    if count < 1.0:
        raise file.error(
            f"{clip.title} lasts {seconds:.3g} s, less than a frame at {fps:g} per second",
            "; give more frames per second",
        )
    if count > MOST_FRAMES:
        raise file.error(f"{clip.title} lasts {seconds:.4g} s, too long at {fps:g} frames per second", "")
    return np.asarray(clip.start + np.arange(int(count) + 1) / fps)
