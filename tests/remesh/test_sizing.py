"""Metrics against closed forms; curvature that does not depend on the mesh; options out of range."""

from dataclasses import fields, replace

import numpy as np
import pytest

from tests.remesh.cloth_samples import (
    cloth,
    grid_faces,
    grid_points,
    jittered,
    random_delaunay,
    right_grid,
    sphere_cap,
)
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError
from toile.geometry.patch import bending_patches
from toile.geometry.topology import triangle_topology
from toile.remesh.mesh.cloth_mesh import ClothMesh
from toile.remesh.sizing.plane_tensor import eigenvalues
from toile.remesh.sizing.sizing import (
    SizingOptions,
    clamped,
    compression_metric,
    curvature_metric,
    obstacle_metric,
    velocity_metric,
)
from toile.remesh.sizing.smooth_curvature import smoothed_curvature
from toile.remesh.sizing.vertex_tensors import vertex_tensors

OPTIONS = SizingOptions(size_min=0.005, size_max=0.1)
UNSTRETCHED = np.array([[[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]]])


def turn_about(axis: Float, angle: float) -> Float:
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def test_cylinder_asks_for_edges_that_turn_by_the_angle() -> None:
    metric = curvature_metric(np.array([[[20.0, 0.0], [0.0, 0.0]]]), 0.3)
    assert np.allclose(1.0 / np.sqrt(metric[0, 0, 0]), 0.3 / 20.0)
    assert metric[0, 1, 1] == 0.0


def test_rigid_motion_asks_for_nothing() -> None:
    rng = np.random.default_rng(1)
    deformation = rng.normal(size=(20, 3, 2))
    spin = rng.normal(size=(20, 1, 3))
    gradient = np.cross(spin, deformation.transpose(0, 2, 1)).transpose(0, 2, 1)
    assert np.abs(velocity_metric(deformation, gradient, 0.5)).max() < 1e-24 / 1e-3
    assert not velocity_metric(deformation, 0.0 * gradient, 0.5).any()


def test_strain_rate_is_kept_whatever_the_rotation() -> None:
    rate = np.array([[3.0, 0.5], [0.5, -1.0]])
    turn = turn_about(np.array([0.6, 0.0, 0.8]), 1.1)
    spin = np.cross(np.array([5.0, -2.0, 7.0]), np.eye(3)).T
    deformation = turn @ UNSTRETCHED
    gradient = turn @ UNSTRETCHED @ rate + spin @ deformation
    metric = velocity_metric(deformation, gradient, 0.5)
    assert np.allclose(metric[0], rate @ rate / 0.25)


def test_cloth_without_extent_spins_not() -> None:
    assert np.isfinite(velocity_metric(np.zeros((1, 3, 2)), np.ones((1, 3, 2)), 0.5)).all()


def stretched(u: float, v: float) -> Float:
    return np.asarray(UNSTRETCHED * np.array([u, v]))


def test_compression_asks_where_it_compresses_only() -> None:
    c, strain = 0.005, 0.02
    flat = np.zeros((1, 2, 2))
    metric = compression_metric(stretched(np.sqrt(1 - strain), 1.1), flat, c)[0]
    assert np.allclose(metric, [[strain / c**2, 0.0], [0.0, 0.0]], atol=1e-9)
    assert np.abs(compression_metric(stretched(1.05, 1.0), flat, c)).max() < 1e-9


def test_curvature_across_stiffens_against_buckling() -> None:
    c, strain = 0.005, 0.02
    compressed = stretched(np.sqrt(1 - strain), 1.0)
    curvature = 1.5
    metric = compression_metric(compressed, np.array([[[0.0, 0.0], [0.0, curvature]]]), c)[0]
    root = np.sqrt(strain**2 - 4 * c**2 * curvature**2)
    assert np.isclose(metric[0, 0], (strain + root) / (2 * c**2))
    held = compression_metric(compressed, np.array([[[0.0, 0.0], [0.0, 10.0]]]), c)[0]
    assert np.abs(held).max() < 1e-9


def test_obstacle_asks_for_edges_as_long_as_it_is_far() -> None:
    metric = obstacle_metric(np.array([[0.6, 0.8]]), np.array([0.02]))[0]
    along = np.array([0.6, 0.8])
    assert np.isclose(along @ metric @ along, 1 / 0.02**2)
    assert np.isclose(np.linalg.det(metric), 0.0)


def test_clamped_sizes_and_aspect_are_within_bounds() -> None:
    factors = (
        np.random.default_rng(2).normal(size=(500, 2, 2)) * 10.0 ** np.linspace(-1, 4, 500)[:, None, None]
    )
    metric = np.einsum("nki,nkj->nij", factors, factors)
    low, high = eigenvalues(clamped(metric, OPTIONS))
    assert high.max() <= 1.000001 / OPTIONS.size_min**2
    assert low.min() >= 0.999999 / OPTIONS.size_max**2
    assert np.sqrt(low / high).min() >= 0.999999 * OPTIONS.aspect_min
    inside = np.tile(np.diag([1 / 0.02**2, 1 / 0.05**2]), (1, 1, 1))
    assert np.allclose(clamped(inside, OPTIONS), inside)


def curvatures(mesh: ClothMesh) -> Float:
    """Second fundamental form of every face in its own directions [1/m], shape (t, 2, 2)."""
    nodes = mesh.face_nodes
    corners = mesh.positions[nodes]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    patches = bending_patches(nodes, mesh.rest_corners, triangle_topology(nodes), len(mesh.positions))
    second = (patches.second_derivatives @ mesh.positions).reshape(-1, 3, 3)
    uu, vv, uv = np.einsum("tdi,ti->td", second, normal).T
    return np.asarray(np.stack([np.stack([uu, uv], axis=1), np.stack([uv, vv], axis=1)], axis=1))


WAVELENGTH, SLOPE = 0.25, 0.5


def wave(count: int, kind: str, noise: float, seed: int = 5) -> ClothMesh:
    """A unit square rolled into a sine: rest coordinate u is arc length along it."""
    flat = right_grid(count) if kind == "grid" else jittered(count)
    k = 2 * np.pi / WAVELENGTH
    x = np.linspace(0.0, 1.0, 20001)
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), SLOPE / k * np.diff(np.sin(k * x))))])
    along = np.interp(flat.rest[:, 0], arc, x)
    places = np.stack([along, flat.rest[:, 1], SLOPE / k * np.sin(k * along)], axis=1)
    places += noise / count * np.random.default_rng(seed).normal(size=places.shape)
    return cloth(flat.rest, flat.faces, positions=places)


def wanted_density(mesh: ClothMesh) -> Float:
    """Largest wanted density of edges [1/m] in strips across the wave, shape (12,)."""
    options = SizingOptions(size_min=0.002, size_max=1.0, aspect_min=0.01)
    metric = curvature_metric(smoothed_curvature(mesh, curvatures(mesh), options), options.refine_angle)
    middle = mesh.rest[mesh.faces].mean(axis=1)[:, 0]
    inside = (middle > 0.1) & (middle < 0.9)
    strip = ((middle[inside] - 0.1) / 0.8 * 12).astype(int)
    area = mesh.rest_area[inside]
    share = np.bincount(strip, weights=area)
    mean: Float = np.bincount(strip, weights=area * eigenvalues(metric[inside])[1]) / share
    return np.asarray(np.sqrt(mean))


@pytest.mark.parametrize("kind", ["grid", "jittered"])
def test_sizing_is_a_property_of_the_surface(kind: str) -> None:
    k = 2 * np.pi / WAVELENGTH
    sharpest = SLOPE * k / 0.3
    exact = wanted_density(wave(240, "grid", 0.0))
    assert 0.8 * sharpest < exact.max() < sharpest
    for count in (60, 120):
        clean, noisy = wanted_density(wave(count, kind, 0.0)), wanted_density(wave(count, kind, 0.02))
        bent = exact > 0.4 * exact.max()
        assert np.abs(clean[bent] / exact[bent] - 1).max() < 0.25
        assert np.abs(noisy[bent] / exact[bent] - 1).max() < 0.25
        assert noisy[~bent].max() < 0.6 * exact.max()


def crease(count: int, fold: float) -> ClothMesh:
    """A unit square folded along the line u = 1/2."""
    rest = grid_points(count, count)
    x, y, _ = rest.T
    places = np.stack([x, y, -np.abs(x - 0.5) * np.tan(fold / 2)], axis=1)
    return cloth(rest, grid_faces(count, count), positions=places)


def test_a_blunt_crease_does_not_get_sharper_with_every_split() -> None:
    """A crease by less than the angle never asks for edges shorter than it has, however fine the mesh is."""
    sharpest = []
    for count in (16, 32, 64):
        mesh = crease(count, 0.2)
        smooth = float(np.abs(smoothed_curvature(mesh, curvatures(mesh), OPTIONS)).max())
        assert smooth / count / OPTIONS.refine_angle < 0.5
        sharpest.append(smooth)
    raw = [float(np.abs(curvatures(crease(count, 0.2))).max()) for count in (16, 64)]
    assert raw[1] / raw[0] > 3.9
    assert sharpest[2] / sharpest[0] < 1.7


def test_a_sharp_crease_is_seen_on_every_mesh() -> None:
    for count in (16, 32, 64):
        mesh = crease(count, 0.5)
        smooth = np.abs(smoothed_curvature(mesh, curvatures(mesh), OPTIONS)).max()
        assert smooth / count / OPTIONS.refine_angle > 1.0


def test_smoothing_keeps_constant_curvature_and_stops_at_seams() -> None:
    mesh = right_grid(10)
    region = (mesh.rest[mesh.faces].mean(axis=1)[:, 0] > 0.5).astype(np.int32)
    two = cloth(mesh.rest, mesh.faces, region=region)
    curvature = np.where(region[:, None, None] == 1, 1.0, -1.0) * np.array([[1.0, 0.3], [0.3, 0.2]])
    assert np.abs(smoothed_curvature(two, curvature, OPTIONS) - curvature).max() < 1e-12


def test_vertex_tensors_of_a_constant_metric() -> None:
    mesh = random_delaunay(5)
    metric = np.array([[4.0, 1.0], [1.0, 2.0]])
    tensors = vertex_tensors(mesh, np.tile(metric, (len(mesh.faces), 1, 1)))
    assert np.abs(tensors[:, :2, :2] - metric).max() < 1e-12
    assert not tensors[:, 2].any()


def test_vertex_tensors_do_not_depend_on_the_frames_of_faces() -> None:
    """On a curved rest shape with a frame per face, equal lengths in all directions are the tangent plane."""
    mesh = sphere_cap(12)
    tensors = vertex_tensors(mesh, np.tile(np.eye(2) / 0.1**2, (len(mesh.faces), 1, 1)))
    normal = mesh.rest
    plane = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    assert np.abs(0.01 * tensors - plane).max() < 0.15


@pytest.mark.parametrize("name", [entry.name for entry in fields(SizingOptions)])
@pytest.mark.parametrize("value", [0.0, -0.25, float("nan"), float("inf"), -float("inf"), True, "1", None])
def test_sizing_option_that_is_no_positive_number_is_named(name: str, value: object) -> None:
    with pytest.raises(InputError) as caught:
        SizingOptions(**({"size_min": 0.005, "size_max": 0.1} | {name: value}))  # type: ignore[arg-type]
    message = str(caught.value)
    shown = f"{value:g}" if isinstance(value, float) else repr(value)
    assert message.startswith(f"{name} must be ")
    assert f", got {shown}; give " in message and "\n" not in message


def test_sizes_in_the_wrong_order_are_named() -> None:
    expected = "size_min must not exceed size_max, 0.1 m, got 0.2 m; lower size_min or raise size_max"
    with pytest.raises(InputError) as caught:
        SizingOptions(size_min=0.2, size_max=0.1)
    assert str(caught.value) == expected
    with pytest.raises(InputError, match="size_min must not exceed size_max"):
        replace(OPTIONS, size_max=0.001)


def test_aspect_above_one_is_named() -> None:
    expected = (
        "aspect_min must not exceed 1, got 1.5; give a ratio such as 0.2, or 1 for triangles of equal edges"
    )
    with pytest.raises(InputError) as caught:
        SizingOptions(size_min=0.005, size_max=0.1, aspect_min=1.5)
    assert str(caught.value) == expected


def test_sizing_options_at_their_limits_are_taken() -> None:
    options = SizingOptions(size_min=1, size_max=1, refine_angle=1e6, aspect_min=1.0)
    metric = np.array([[[9.0, 1.0], [1.0, 0.0]]])
    assert np.allclose(clamped(metric, options), np.eye(2))
