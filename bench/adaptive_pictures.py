"""The adaptive mesh over the folds, drawn as a wireframe: a film of the sphere scene, a picture of a shirt.

Run: python bench/adaptive_pictures.py docs/images     (needs Pillow)

Writes adaptive_sphere.gif, every second frame of the film, and adaptive_shirt.png, the built-in T-shirt on
the mannequin at `standard`, uniform beside adaptive.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

import toile
from toile.dressing.pictures.rasterizer import rasterize
from toile.dressing.run.quality import COARSEST
from toile.engine.film.plan import FilmFrame
from toile.engine.film.simulate import Simulation
from toile.remesh.sizing.sizing import SizingOptions
from toile.studies.adaptive.remesh import FINEST, START
from toile.studies.scenes.scenes import sphere

SAMPLES = 3
"""Samples per pixel in each direction."""
SMOOTH = 0.4
"""Turn of the surface per edge in the film [rad]."""
CLOTH, BODY, LINE, PAPER = (98, 138, 186), (222, 196, 178), (20, 32, 56), (246, 246, 244)
LIGHT = np.array([-0.4, 0.75, 0.55])


def view_of(target: np.ndarray, turn: float, pitch: float) -> tuple[np.ndarray, np.ndarray]:
    """Axes right, up, towards the eye as rows, and the point in the middle of the picture."""
    t, p = np.radians(turn), np.radians(pitch)
    right = np.array([np.cos(t), 0.0, -np.sin(t)])
    near = np.array([np.sin(t) * np.cos(p), np.sin(p), np.cos(t) * np.cos(p)])
    return np.stack([right, np.cross(near, right), near]), target


def wireframe(
    cloth: tuple[np.ndarray, np.ndarray], body: tuple[np.ndarray, np.ndarray],
    view: tuple[np.ndarray, np.ndarray], metres: float, width: int, height: int,
) -> Image.Image:  # fmt: skip
    """Draw cloth with the edges of its triangles and a body without; the picture is `metres` high."""
    positions = np.concatenate([cloth[0], body[0]])
    faces = np.concatenate([cloth[1], body[1] + len(cloth[0])]).astype(np.int32)
    axes, target = view
    at = (positions - target) @ axes.T * (SAMPLES * height / metres)
    screen = np.column_stack([0.5 * SAMPLES * width + at[:, 0], 0.5 * SAMPLES * height - at[:, 1], at[:, 2]])
    _, face_at = rasterize(screen, faces, SAMPLES * width, SAMPLES * height, far=-1e9)
    a, b, c = (positions[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    facing = np.where((normal @ axes[2])[:, None] < 0.0, -normal, normal)
    light = 0.55 + 0.5 * np.maximum(facing @ (LIGHT / np.linalg.norm(LIGHT)), 0.0)
    is_cloth = np.arange(len(faces)) < len(cloth[1])
    colour = np.where(is_cloth[:, None], CLOTH, BODY) * np.minimum(light, 1.05)[:, None]
    picture = np.where((face_at >= 0)[..., None], colour[face_at], PAPER)
    line = np.zeros(face_at.shape, bool)
    for axis in (0, 1):
        other = np.roll(face_at, 1, axis=axis)
        changes = face_at != other
        for one in (face_at, other):
            line |= changes & (one >= 0) & is_cloth[one]
    picture = np.where(line[..., None], LINE, picture)
    pixels = picture.reshape(height, SAMPLES, width, SAMPLES, 3).mean(axis=(1, 3))
    return Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8))


def film(path: Path) -> None:
    """Write the film of the sphere scene."""
    finest = FINEST["sphere"]
    scene = sphere(START * finest)
    sizing = SizingOptions(size_min=finest, size_max=COARSEST * finest, refine_angle=SMOOTH)
    view = view_of(np.array([0.0, -0.08, 0.0]), 30.0, 28.0)
    pictures = []

    def on_frame(frame: FilmFrame) -> bool:
        if frame.index % 2 == 0:
            surface = frame.cloth.positions, frame.cloth.face_nodes
            pictures.append(wireframe(surface, scene.avatar, view, 1.05, 520, 400))
        return True

    # A mesh per shown frame: the film is to show the mesh at work.
    Simulation(scene.cloth, scene.avatar, replace(scene.plan, sizing=sizing, remesh_frames=2), on_frame).run(
        scene.seconds
    )
    palette = [picture.quantize(48, dither=Image.Dither.NONE) for picture in pictures]
    palette[0].save(path, save_all=True, append_images=palette[1:], duration=70, loop=0, optimize=True)
    print(f"{path}: {len(pictures)} frames, {path.stat().st_size / 1e6:.1f} MB")


def shirt(path: Path) -> None:
    """Write the picture of the shirt, uniform on the left, adaptive on the right."""
    pictures = []
    for remesh in (False, True):
        result = toile.dress(toile.Scene(garments=[toile.Garment("tshirt")], remesh=remesh))
        garment = result.garments[0]
        print(f"remesh={remesh}: {len(garment.faces)} faces, {result.report['cpu_seconds']:.0f} CPU s")
        body = result.avatar.vertices, result.avatar.faces
        view = view_of(np.array([0.0, 1.22, 0.0]), 25.0, 5.0)
        pictures.append(wireframe((garment.positions, garment.faces), body, view, 0.8, 800, 800))
    both = Image.new("RGB", (1600, 800))
    both.paste(pictures[0], (0, 0))
    both.paste(pictures[1], (800, 0))
    both.quantize(128, dither=Image.Dither.NONE).save(path, optimize=True)
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    film(folder / "adaptive_sphere.gif")
    shirt(folder / "adaptive_shirt.png")


if __name__ == "__main__":
    main()
