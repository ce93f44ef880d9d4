"""Bodies of any shape, size and place come back as they were written, in every format and option."""

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import meshio
import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from tests.dressing.files.gltf_writer import Glb
from toile.dressing.files.read_surface import read_surface
from toile.geometry.arrays import Float, Int

WITHIN = 1e-6
"""Largest distance, relative to the size of the body with its place."""


class Body(NamedTuple):
    points: Float
    faces: Int
    random: np.random.Generator


@st.composite
def bodies(draw: st.DrawFn) -> Body:
    """A blob of 80 triangles, no two of them alike, of any size and somewhere near the origin."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    ball = trimesh.creation.icosphere(subdivisions=1)
    size = 10.0 ** draw(st.floats(-2.0, 3.0))
    points = ball.vertices * random.uniform(0.5, 1.0, (len(ball.vertices), 1)) * random.uniform(0.3, 1.0, 3)
    points = size * (points + random.uniform(-1.0, 1.0, 3))
    return Body(np.asarray(points, np.float64), np.asarray(ball.faces, np.int32), random)


def facts(triangles: Float) -> Float:
    """Centroid and normal, as long as the root of the area, of every triangle, shape (t, 6)."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.hstack([triangles.mean(axis=1), normal / np.sqrt(np.where(length > 0.0, length, 1.0))])


def assert_comes_back(path: Path, expected: Float, within: float = WITHIN) -> None:
    """The file holds these triangles (t, 3, 3) and no others, looking the same way."""
    surface = read_surface(path, "the body").surface
    found = surface.positions[surface.faces]
    assert len(found) == len(expected)
    size = float(np.abs(expected).max())
    # The normal of a triangle of a tenth of the size is as exact as the tenth of its corners.
    distance, partner = cKDTree(facts(found)).query(facts(expected))
    assert np.asarray(distance).max() < 100.0 * within * size
    assert len(np.unique(partner)) == len(expected)
    corners = np.asarray(found)[np.asarray(partner)]
    best = np.min(
        [np.abs(np.roll(corners, turn, axis=1) - expected).max(axis=(1, 2)) for turn in range(3)], axis=0
    )
    assert best.max() < within * size


def mesh_of(body: Body, *, colours: bool = False, texture: bool = False) -> trimesh.Trimesh:
    mesh = trimesh.Trimesh(body.points, body.faces, process=False)
    if colours:
        mesh.visual.vertex_colors = np.full((len(body.points), 4), 200, np.uint8)
    if texture:
        mesh.visual = trimesh.visual.TextureVisuals(uv=body.points[:, :2])
    return mesh


TRIMESH: dict[str, tuple[str, dict[str, Any], dict[str, bool]]] = {
    "obj": ("obj", {}, {}),
    "obj normals": ("obj", {"include_normals": True}, {}),
    "obj digits": ("obj", {"digits": 12}, {}),
    "obj colours": ("obj", {"include_color": True}, {"colours": True}),
    "ply": ("ply", {}, {}),
    "ply text": ("ply", {"encoding": "ascii"}, {}),
    "ply normals": ("ply", {"vertex_normal": True}, {}),
    "ply text normals": ("ply", {"encoding": "ascii", "vertex_normal": True}, {}),
    "ply colours": ("ply", {}, {"colours": True}),
    "ply text colours": ("ply", {"encoding": "ascii"}, {"colours": True}),
    "stl": ("stl", {}, {}),
    "stl text": ("stl_ascii", {}, {}),
    "glb": ("glb", {}, {}),
    "glb normals": ("glb", {"include_normals": True}, {}),
    "glb colours": ("glb", {}, {"colours": True}),
    "glb texture": ("glb", {}, {"texture": True}),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("trips")


CALM = settings(max_examples=6, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.mark.parametrize("name", TRIMESH)
@given(body=bodies())
@CALM
def test_what_trimesh_writes(name: str, folder: Path, body: Body) -> None:
    kind, options, looks = TRIMESH[name]
    data = mesh_of(body, **looks).export(file_type=kind, **options)
    path = folder / f"{name.replace(' ', '_')}.{kind.removesuffix('_ascii')}"
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    # Eight digits behind the point are few for a body of a centimetre.
    assert_comes_back(path, body.points[body.faces], 1e-5 if kind in ("obj", "stl_ascii") else WITHIN)


def moved(points: Float, transform: Float) -> Float:
    return np.asarray(points @ transform[:3, :3].T + transform[:3, 3])


def some_place(body: Body, mirror: bool = False) -> Float:
    """A turn, a shift and a scale per axis."""
    transform = np.eye(4)
    turn = Rotation.random(random_state=int(body.random.integers(1 << 30))).as_matrix()
    transform[:3, :3] = turn @ np.diag(body.random.uniform(0.5, 2.0, 3) * ((-1 if mirror else 1), 1, 1))
    transform[:3, 3] = body.random.uniform(-1.0, 1.0, 3) * np.abs(body.points).max()
    return transform


@pytest.mark.parametrize("kind", ["glb", "gltf"])
@given(body=bodies())
@CALM
def test_scenes_that_trimesh_writes(kind: str, folder: Path, body: Body) -> None:
    """A mesh in two places, one below the other, and a mesh of its own."""
    first, second = some_place(body), some_place(body)
    scene = trimesh.Scene()
    scene.add_geometry(mesh_of(body), geom_name="a", node_name="one", transform=first)
    scene.add_geometry(
        mesh_of(body), geom_name="b", node_name="two", parent_node_name="one", transform=second
    )
    data = scene.export(file_type=kind)
    place = folder / f"scene_{kind}"
    place.mkdir(exist_ok=True)
    if isinstance(data, dict):
        for name, content in data.items():
            (place / name).write_bytes(content)
        path = place / "model.gltf"
    else:
        path = place / "model.glb"
        path.write_bytes(data)
    points = [moved(body.points, first), moved(moved(body.points, second), first)]
    assert_comes_back(path, np.concatenate([each[body.faces] for each in points]))


MESHIO: dict[str, tuple[str, dict[str, Any]]] = {
    "vtu": ("vtu", {}),
    "vtu text": ("vtu", {"binary": False}),
    "vtu uncompressed": ("vtu", {"compression": None}),
    "vtk": ("vtk", {}),
    "vtk text": ("vtk", {"binary": False}),
    "msh": ("gmsh", {}),
    "msh text": ("gmsh", {"binary": False}),
    "inp": ("abaqus", {}),
}


@pytest.mark.parametrize("name", MESHIO)
@given(body=bodies())
@CALM
def test_what_meshio_writes(name: str, folder: Path, body: Body) -> None:
    kind, options = MESHIO[name]
    ending = {"gmsh": "msh", "abaqus": "inp"}.get(kind, kind)
    path = folder / f"{name.replace(' ', '_')}.{ending}"
    meshio.write(path, meshio.Mesh(body.points, [("triangle", body.faces)]), file_format=kind, **options)
    assert_comes_back(path, body.points[body.faces])


Feature = Callable[[Glb, Body, str], Float]
"""Adds a body, its positions stored as a type, to a file, and returns the points expected."""
PACKED = {"<f4": 1.0, "<i2": 32767.0, "<u2": 65535.0, "normalised <i2": 32767.0, "normalised <u1": 255.0}


def stored(glb: Glb, body: Body, dtype: str) -> tuple[int, Float, Float]:
    """A mesh, the points that its numbers say, and the place of the node that undoes their packing."""
    if dtype == "<f4":
        return glb.mesh(body.points, body.faces), body.points, np.eye(4)
    low, high = body.points.min(axis=0), body.points.max(axis=0)
    most = PACKED[dtype]
    share = np.round((body.points - low) / (high - low).max() * most)
    mesh = glb.mesh(np.zeros((3, 3)), body.faces)
    is_normal = dtype.startswith("normalised")
    accessor = glb.numbers(share, dtype.split()[-1], normalized=is_normal)
    glb.json["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"] = accessor
    points = share / most if is_normal else share
    place = np.diag([*[(high - low).max() / (1.0 if is_normal else most)] * 3, 1.0])
    place[:3, 3] = low
    return mesh, points, place


def at_a_node(glb: Glb, body: Body, dtype: str) -> Float:
    mesh, points, place = stored(glb, body, dtype)
    glb.node(mesh=mesh, matrix=place.T.ravel().tolist())
    return moved(points, place)


def below_two_nodes(glb: Glb, body: Body, dtype: str) -> Float:
    mesh, points, place = stored(glb, body, dtype)
    outer = some_place(body, mirror=True)
    leaf = glb.node(
        root=False, mesh=mesh, translation=place[:3, 3].tolist(), scale=np.diag(place)[:3].tolist()
    )
    glb.node(children=[leaf], matrix=outer.T.ravel().tolist())
    return moved(moved(points, place), outer)


def instanced(glb: Glb, body: Body, dtype: str) -> Float:
    """One instance, beside a place of the node."""
    mesh, points, place = stored(glb, body, dtype)
    turn = Rotation.random(random_state=3)
    shift = body.random.uniform(-1.0, 1.0, 3)
    attributes = {"TRANSLATION": glb.numbers([shift]), "ROTATION": glb.numbers([turn.as_quat()])}
    glb.node(
        mesh=mesh, matrix=place.T.ravel().tolist(),
        extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}},
    )  # fmt: skip
    return moved(turn.apply(points) + shift, place)


def morphed(glb: Glb, body: Body, dtype: str) -> Float:
    mesh, points, place = stored(glb, body, dtype)
    moves = body.random.normal(size=(2, *points.shape)) * 0.01 * np.abs(points).max()
    targets = [{"POSITION": glb.numbers(move)} for move in moves]
    glb.json["meshes"][mesh]["primitives"][0]["targets"] = targets
    glb.node(mesh=mesh, weights=[0.5, -1.0], matrix=place.T.ravel().tolist())
    return moved(points + 0.5 * moves[0] - moves[1], place)


def skinned(glb: Glb, body: Body, dtype: str) -> Float:
    """Two bones below a scaled armature; the packing of positions is undone by the bind matrices."""
    mesh, points, place = stored(glb, body, dtype)
    attributes = glb.json["meshes"][mesh]["primitives"][0]["attributes"]
    share = body.random.uniform(0.0, 1.0, len(points)).astype(np.float32).astype(np.float64)
    attributes["JOINTS_0"] = glb.numbers(np.tile([0, 1, 0, 0], (len(points), 1)), "<u1")
    attributes["WEIGHTS_0"] = glb.numbers(np.column_stack([1.0 - share, share, 0 * share, 0 * share]))
    turn = Rotation.from_euler("xyz", body.random.uniform(-1.0, 1.0, 3))
    tip = glb.node(root=False, rotation=turn.as_quat().tolist())
    base = glb.node(root=False, children=[tip])
    bind = np.tile(np.diag([2.0, 2.0, 2.0, 1.0]) @ place, (2, 1, 1))
    skin = glb.add("skins", joints=[base, tip], inverseBindMatrices=glb.numbers(bind.swapaxes(1, 2)))
    own = glb.node(root=False, mesh=mesh, skin=skin, translation=[9.0, 9.0, 9.0])
    glb.node(scale=[0.5, 0.5, 0.5], children=[own, base])
    still = moved(points, place)
    return (1.0 - share)[:, None] * still + share[:, None] * turn.apply(still)


def sparse(glb: Glb, body: Body, dtype: str) -> Float:
    """Every third vertex is replaced by one halfway to the middle."""
    mesh, points, place = stored(glb, body, dtype)
    rows = np.arange(0, len(points), 3)
    values = np.round(0.5 * points[rows]) if "f4" not in dtype and "norm" not in dtype else 0.5 * points[rows]
    if dtype.startswith("normalised"):
        values = np.round(values * PACKED[dtype]) / PACKED[dtype]
    raw = values * PACKED[dtype] if dtype.startswith("normalised") else values
    views = glb.numbers(rows, "<u2"), glb.numbers(np.round(raw) if dtype != "<f4" else raw, dtype.split()[-1])
    accessor = glb.json["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"]
    glb.json["accessors"][accessor]["sparse"] = {
        "count": len(rows),
        "indices": {"bufferView": views[0], "componentType": 5123},
        "values": {"bufferView": views[1]},
    }
    glb.node(mesh=mesh, matrix=place.T.ravel().tolist())
    expected = points.copy()
    expected[rows] = values
    return moved(expected, place)


FEATURES: tuple[Feature, ...] = (at_a_node, below_two_nodes, instanced, morphed, skinned, sparse)


@pytest.mark.parametrize(("feature", "dtype"), list(product(FEATURES, PACKED)))
@given(body=bodies())
@CALM
def test_gltf_of_every_feature(feature: Feature, dtype: str, folder: Path, body: Body) -> None:
    glb = Glb()
    expected = feature(glb, body, dtype)
    ending = "gltf" if body.random.integers(2) else "glb"
    path = glb.write(folder / f"{feature.__name__}.{ending}")
    triangles = expected[body.faces]
    if feature is below_two_nodes:
        # A mirror turns triangles over, and the reader back.
        triangles = triangles[:, ::-1]
    if "<u1" in dtype:
        # Bytes leave some triangles without area, and others alike.
        surface = read_surface(path, "the body").surface
        assert np.abs(surface.positions - expected).max() < WITHIN * np.abs(expected).max()
        return
    assert_comes_back(path, triangles)
