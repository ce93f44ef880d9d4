"""preview.png: front and back of a dressed body, drawn without graphics hardware."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter

from toile.dressing.files.palette import linear
from toile.dressing.pictures.rasterizer import rasterize
from toile.dressing.pictures.shading import shade, spiral_disc
from toile.geometry.arrays import Float, Int
from toile.geometry.normals import drawn_normals

Pixels = npt.NDArray[np.uint8]
HEIGHT = 1000
"""Height of the picture [pixels]."""
PANEL_SHAPES = 0.6, 0.95
"""Narrowest and widest view, as width / height: a body with its arms out gets more room."""
SUPERSAMPLING = 3
"""Samples per pixel in each direction."""
VIEW_ANGLE = 16.0
"""Vertical view angle [degrees]: mild perspective, as through a long lens."""
PITCH = 5.0
"""How far the camera looks down [degrees]."""
MARGIN = 1.08
"""Room around the body."""
SHADOW_SIZE = 1400
"""Edge of the key light's depth buffer [pixels]."""
SHADOW_SOFTNESS = 0.012
"""Radius over which a shadow's edge fades [m]."""
KEY_LIGHT = np.array([-0.74, 0.62, -0.50])
"""Direction to the key light in view space: from the upper left."""
BACKDROP_TOP, BACKDROP_BOTTOM = (0.885, 0.890, 0.900), (0.965, 0.960, 0.950)
"""sRGB of the background."""


class PreviewMesh(NamedTuple):
    """Something to draw: positions [m] (n, 3), faces (t, 3), sRGB colour, and whether it is cloth.

    `shades` are colours of its faces instead of one for all: sRGB of each colour, and its number per face.
    """

    positions: Float
    faces: Int
    colour: tuple[float, float, float]
    double_sided: bool = False
    shades: tuple[Sequence[tuple[float, float, float]], Int] | None = None


class _Model(NamedTuple):
    """All meshes as one: vertices, normals, faces, material of each face, colours of each material."""

    positions: Float
    normals: Float
    faces: Int
    material: Int
    colours: Float


class _Camera(NamedTuple):
    """World to view space: rows right, up, depth; position [m]; focal length and image size [pixels]."""

    axes: Float
    eye: Float
    focal: float
    width: int
    height: int


def render(meshes: Sequence[PreviewMesh], height: int = HEIGHT) -> Pixels:
    """Return a picture of the meshes from the front (left half) and the back, shape (height, width, 3)."""
    model = _joined(meshes)
    floor, width = _floor_shadow(model), _width(model, height)
    views = [_view(model, floor, angle, width, height) for angle in (0.0, 180.0)]
    return np.ascontiguousarray(np.concatenate(views, axis=1))


def render_front(
    meshes: Sequence[PreviewMesh], height: int = HEIGHT
) -> tuple[Pixels, Callable[[Float], Float]]:
    """Return a picture from the front, and the function that takes points [m] to its (column, row)."""
    model = _joined(meshes)
    width = _width(model, height)
    camera = _framed(model.positions, 0.0, width, height)

    def project(points: Float) -> Float:
        return _on_screen(camera, (points - camera.eye) @ camera.axes.T)

    return _view(model, _floor_shadow(model), 0.0, width, height), project


def _width(model: _Model, height: int) -> int:
    """Return the width of a view that has room for the model [pixels]."""
    size = np.ptp(model.positions, axis=0)
    shape = min(max(1.05 * size[0] / max(size[1], 1e-9), PANEL_SHAPES[0]), PANEL_SHAPES[1])
    return round(float(shape) * height)


def _on_screen(camera: _Camera, positions: Float) -> Float:
    """Return the (column, row) of points in view space."""
    centre = np.array([0.5 * (camera.width - 1), 0.5 * (camera.height - 1)])
    offset = camera.focal * positions[:, :2] / positions[:, 2:]
    return np.asarray(centre + offset * (1.0, -1.0))


def _joined(meshes: Sequence[PreviewMesh]) -> _Model:
    """Return the meshes as one model; the wrong side of cloth is a little darker and greyer."""
    positions, normals, faces, material = [], [], [], []
    colours: list[list[float]] = []
    count = 0
    for mesh in (PreviewMesh(*mesh) for mesh in meshes):
        positions.append(np.asarray(mesh.positions, dtype=np.float64))
        normals.append(drawn_normals(positions[-1], mesh.faces))
        faces.append(np.asarray(mesh.faces, dtype=np.int64) + count)
        shades, of_face = mesh.shades or ([mesh.colour], np.zeros(len(mesh.faces), np.int32))
        material.append(np.asarray(of_face + len(colours), dtype=np.int32))
        for shade_of in shades:
            right = np.array(linear(shade_of))
            wrong = 0.62 * (0.75 * right + 0.25 * right.mean())
            colours.append([*right, *wrong, float(mesh.double_sided)])
        count += len(positions[-1])
    return _Model(
        np.concatenate(positions),
        np.concatenate(normals),
        np.ascontiguousarray(np.concatenate(faces), dtype=np.int32),
        np.concatenate(material),
        np.array(colours),
    )


def _view(model: _Model, floor: "_Floor", angle: float, width: int, height: int) -> Pixels:
    """Return the picture from one side, angle [degrees] around the vertical, shape (height, width, 3)."""
    camera = _framed(model.positions, angle, width * SUPERSAMPLING, height * SUPERSAMPLING)
    positions = np.ascontiguousarray((model.positions - camera.eye) @ camera.axes.T)
    normals = np.ascontiguousarray(model.normals @ camera.axes.T)
    centre = 0.5 * (camera.width - 1), 0.5 * (camera.height - 1)
    screen = np.column_stack([_on_screen(camera, positions), 1.0 / positions[:, 2]])
    nearness, face_at = rasterize(screen, model.faces, camera.width, camera.height, far=0.0)
    key = KEY_LIGHT / np.linalg.norm(KEY_LIGHT)
    to_shadow, scale = _shadow_frame(positions, key)
    in_shadow = positions @ to_shadow[:, :3].T + to_shadow[:, 3]
    shadow, _ = rasterize(in_shadow, model.faces, SHADOW_SIZE, SHADOW_SIZE, far=-1e9)
    drawn = np.zeros((height, width, 4))
    pitch = np.radians(PITCH)
    shade(
        nearness,
        face_at,
        positions,
        normals,
        model.faces,
        model.material,
        model.colours,
        shadow,
        to_shadow,
        np.array([camera.focal, *centre, SHADOW_SOFTNESS * scale, np.sin(pitch), np.cos(pitch)]),
        key,
        spiral_disc(24),
        spiral_disc(16),
        drawn,
    )
    behind = _backdrop(_framed(model.positions, angle, width, height), floor)
    return _developed(drawn[..., :3] + (1.0 - drawn[..., 3:]) * behind)


def _framed(positions: Float, angle: float, width: int, height: int) -> _Camera:
    """Return the camera that sees everything; the same distance from both sides."""
    low, high = positions.min(axis=0), positions.max(axis=0)
    target = 0.5 * (low + high)
    turn, pitch = np.radians(angle), np.radians(PITCH)
    # From the front (+Z) the body's left (+X) is on the right of the picture.
    right = np.array([np.cos(turn), 0.0, -np.sin(turn)])
    away = np.array([-np.sin(turn) * np.cos(pitch), -np.sin(pitch), -np.cos(turn) * np.cos(pitch)])
    up = np.cross(right, away)
    axes = np.stack([right, up, away])
    focal = 0.5 * height / np.tan(np.radians(0.5 * VIEW_ANGLE))
    offsets = (positions - target) @ axes.T
    # A point at view (x, y, z) is in the picture if |x| focal / (distance + z) <= half the width.
    need_x = np.abs(offsets[:, 0]).max() * focal * MARGIN / (0.5 * width)
    need_y = np.abs(offsets[:, 1]).max() * focal * MARGIN / (0.5 * height)
    distance = max(float(need_x), float(need_y)) - min(float(offsets[:, 2].min()), 0.0)
    return _Camera(axes, target - max(distance, 1e-6) * away, float(focal), width, height)


def _shadow_frame(positions: Float, key: Float) -> tuple[Float, float]:
    """Return view space to shadow map (column, row, nearness), shape (3, 4), and its pixels per metre."""
    side = np.cross(key, (0.0, 1.0, 0.0))
    side /= np.linalg.norm(side)
    over = np.cross(side, key)
    axes = np.stack([side, over, key])
    flat = positions @ axes.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    scale = float((SHADOW_SIZE - 8) / max((high - low)[:2].max(), 1e-9))
    offset = 4.0 - scale * low
    frame = scale * axes
    return np.column_stack([frame, [offset[0], offset[1], 0.0]]), scale


class _Floor(NamedTuple):
    """Light on the floor around the body, 1 where nothing is near: a grid over x and z [m]."""

    light: Float
    origin: Float
    cell: float
    height: float


def _floor_shadow(model: _Model) -> _Floor:
    """Return the floor's light: darker under what is low, in a tight and in a wide blur."""
    corners = model.positions[model.faces]
    centre = corners.mean(axis=1)
    low, high = model.positions.min(axis=0), model.positions.max(axis=0)
    size = float(high[1] - low[1])
    cell = 0.006 * max(size, 1e-6)
    border = 0.5 * size
    origin = np.array([low[0] - border, low[2] - border])
    shape = np.ceil((np.array([high[0], high[2]]) + border - origin) / cell).astype(int) + 1
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.25 * np.abs(u[:, 2] * v[:, 0] - u[:, 0] * v[:, 2]) / cell**2
    index = ((centre[:, [0, 2]] - origin) / cell).astype(int)
    flat = index[:, 0] * shape[1] + index[:, 1]
    light = np.ones(shape)
    for reach, blur, strength in ((0.03, 0.010, 0.55), (0.45, 0.055, 0.42)):
        weight = area * np.exp(-(centre[:, 1] - low[1]) / (reach * size))
        cover = np.bincount(flat, weights=weight, minlength=shape.prod()).reshape(shape)
        light *= 1.0 - strength * np.minimum(gaussian_filter(cover, blur * size / cell), 1.0)
    return _Floor(light, origin, cell, float(low[1]))


def _backdrop(camera: _Camera, floor: _Floor) -> Float:
    """Return an empty picture in linear light: a soft gradient, and the floor's shadow."""
    top, bottom = np.array(linear(BACKDROP_TOP)), np.array(linear(BACKDROP_BOTTOM))
    share = np.linspace(0.0, 1.0, camera.height)[:, None, None]
    image = np.empty((camera.height, camera.width, 3))
    image[:] = (1.0 - share) * top + share * bottom
    first = camera.height // 2
    rows, columns = np.mgrid[first : camera.height, 0 : camera.width]
    x = (columns - 0.5 * (camera.width - 1)) / camera.focal
    y = (0.5 * (camera.height - 1) - rows) / camera.focal
    rays = x[..., None] * camera.axes[0] + y[..., None] * camera.axes[1] + camera.axes[2]
    down = rays[..., 1] < -1e-6
    distance = np.where(down, (floor.height - camera.eye[1]) / np.where(down, rays[..., 1], -1.0), 0.0)
    hit = camera.eye[[0, 2]] + distance[..., None] * rays[..., [0, 2]]
    cell = np.rint((hit - floor.origin) / floor.cell).astype(int)
    inside = down & ((cell >= 0) & (cell < floor.light.shape)).all(axis=-1)
    light = np.ones(down.shape)
    light[inside] = floor.light[cell[inside][:, 0], cell[inside][:, 1]]
    image[first:] *= light[..., None]
    return image


def _developed(light: Float) -> Pixels:
    """Return linear light as sRGB bytes."""
    srgb = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)
    return np.asarray(np.clip(255.0 * srgb + 0.5, 0, 255), dtype=np.uint8)
