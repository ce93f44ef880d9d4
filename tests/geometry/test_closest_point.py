import numpy as np
import trimesh

from toile.geometry.closest_point import closest_points


def test_closest_points_are_those_of_all_faces() -> None:
    """A surface of one large face and many small ones: centres alone would mislead."""
    ball = trimesh.creation.icosphere(subdivisions=1)
    large = np.array([[-1.6, 1.2, -1.6], [1.6, 1.2, -1.6], [0.0, 1.2, 1.6]])
    vertices = np.concatenate([ball.vertices, large])
    faces = np.concatenate([ball.faces, np.arange(3)[None] + len(ball.vertices)]).astype(np.int32)
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (40, 3))
    found = closest_points(points, vertices, faces)
    # Against a fine sample of all faces.
    share = np.array([(i, j, 60 - i - j) for i in range(61) for j in range(61 - i)]) / 60.0
    for index, point in enumerate(points):
        sampled = np.linalg.norm(np.einsum("sc,tci->tsi", share, vertices[faces]) - point, axis=2).min()
        assert sampled - 0.02 <= found.distance[index] <= sampled + 1e-12
    place = found.take(vertices, faces)
    assert np.abs(np.linalg.norm(place - points, axis=1) - found.distance).max() < 1e-12
    assert found.weights.min() >= -1e-12
    assert np.abs(found.weights.sum(axis=1) - 1.0).max() < 1e-12
