import time

import numpy as np
import trimesh

from toile.dressing.pictures.preview import PreviewMesh, render
from toile.dressing.pictures.rasterizer import rasterize
from toile.dressing.pictures.shading import spiral_disc

BODY = (0.8, 0.7, 0.6)


def ball(radius: float, height: float, subdivisions: int = 4) -> tuple[np.ndarray, np.ndarray]:
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    return np.add(mesh.vertices, (0.0, height, 0.0)), np.array(mesh.faces, dtype=np.int32)


def test_rasterizer_agrees_with_brute_force() -> None:
    rng = np.random.default_rng(3)
    screen = np.column_stack([rng.uniform(-3, 23, (30, 2)), rng.uniform(0.1, 1.0, 30)])
    faces = rng.permutation(30).reshape(10, 3).astype(np.int32)
    nearness, face_at = rasterize(screen, faces, 20, 18, far=0.0)
    for row in range(18):
        for column in range(20):
            best, seen = 0.0, -1
            for number, face in enumerate(faces):
                system = np.vstack([screen[face, :2].T, np.ones(3)])
                weights = np.linalg.solve(system, [column, row, 1.0])
                if (weights >= 0.0).all() and weights @ screen[face, 2] > best:
                    best, seen = float(weights @ screen[face, 2]), number
            assert face_at[row, column] == seen
            assert abs(nearness[row, column] - best) < 1e-6


def test_disc_samples_are_even() -> None:
    disc = spiral_disc(64)
    assert np.abs(disc.mean(axis=0)).max() < 0.05
    assert np.mean(np.linalg.norm(disc, axis=1) < 0.5) == 0.25


def test_both_sides_are_shown() -> None:
    positions, faces = ball(0.3, 0.3)
    red, green = (0.9, 0.1, 0.1), (0.1, 0.9, 0.1)
    front = PreviewMesh(np.add(positions, (0.0, 0.0, 0.7)), faces, red)
    back = PreviewMesh(np.add(positions, (0.0, 0.0, -0.7)), faces, green)
    image = render([front, back], height=200).astype(int)
    assert image.shape[0] == 200
    left, right = np.array_split(image[60:140], 2, axis=1)

    def share(view: np.ndarray, high: int, low: int) -> float:
        return float(np.mean(view[..., high] > 1.5 * view[..., low]))

    assert share(left, 0, 1) > 0.3
    assert share(left, 1, 0) < 0.02
    assert share(right, 1, 0) > 0.3
    assert share(right, 0, 1) < 0.02


def test_left_of_the_body_is_right_in_the_front_view() -> None:
    positions, faces = ball(0.3, 0.3)
    small, small_faces = ball(0.1, 0.3)
    meshes = [
        PreviewMesh(positions, faces, (0.5, 0.5, 0.5)),
        PreviewMesh(np.add(small, (0.5, 0.0, 0.0)), small_faces, (0.9, 0.1, 0.1)),
    ]
    image = render(meshes, height=200).astype(int)
    panel = image.shape[1] // 2
    columns = np.flatnonzero((image[..., 0] > 2 * image[..., 1]).any(axis=0))
    front, back = columns[columns < panel], columns[columns >= panel] - panel
    assert front.min() > 0.6 * panel
    assert back.max() < 0.4 * panel


def test_folds_are_darker_inside_and_light_comes_from_above() -> None:
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, 80), np.linspace(0.0, 1.0, 40))
    z = 0.03 * np.cos(2.0 * np.pi * 8.0 * x)
    positions = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    index = np.arange(3200).reshape(40, 80)
    a, b, c, d = (v.ravel() for v in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)
    image = render([PreviewMesh(positions, faces, (0.5, 0.5, 0.5), True)], height=300).astype(float)
    front, _ = np.array_split(image.mean(axis=2)[110:190], 2, axis=1)
    inside = front[:, front.shape[1] // 4 : 3 * front.shape[1] // 4].mean(axis=0)
    assert inside.max() - inside.min() > 40.0


def test_quick_enough() -> None:
    positions, faces = ball(0.5, 0.5, subdivisions=6)  # 82,000 triangles
    start = time.process_time()
    render([PreviewMesh(positions, faces, BODY)])
    assert time.process_time() - start < 12.0  # 2 s on a quiet machine


def test_same_bytes_every_time() -> None:
    meshes = [PreviewMesh(*ball(0.5, 0.5), BODY)]
    assert np.array_equal(render(meshes, height=200), render(meshes, height=200))
