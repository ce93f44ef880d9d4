"""Garments as arrays: what they carry, where they are sewn and pinned, and what follows through remeshing."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.pattern.sewing_edges import SewingEdges
from toile.dressing.run.dress import dress
from toile.dressing.run.load_garment import load_garment
from toile.dressing.run.resolved_scene import resolve
from toile.dressing.run.result import DressedGarment
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError
from toile.remesh.sizing.sizing import SizingOptions


def sheet(count: int, size: float, height: float) -> tuple[Float, Int, Float]:
    """Square sheet of count x count vertices, Y up: vertices, triangles, and where they are in 0..1."""
    side = np.linspace(0.0, 1.0, count)
    u, v = (grid.ravel() for grid in np.meshgrid(side, side))
    vertices = np.column_stack([size * (u - 0.5), np.full(count**2, height), size * (v - 0.5)])
    first = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([first, first + count, first + 1], 1),
            np.stack([first + 1, first + count, first + count + 1], 1),
        ]
    )
    return vertices, faces.astype(np.int32), np.column_stack([u, v])


def write(folder: Path, **arrays: Any) -> Path:
    path = folder / "sheet.npz"
    np.savez(path, **arrays)
    return path


def test_a_drafted_pattern_comes_back_as_it_was(tmp_path: Path) -> None:
    """Panels, warp, stitches and labels survive the way through arrays, as a program would give them."""
    form = DressForm(mannequin())
    (shirt,) = resolve(Scene(garments=[Garment("tshirt")])).garments
    drafted = load_garment(shirt, form, SewingEdges(0.03, 0.03))
    labels: dict[str, Any] = {f"held_{label}": vertices for label, vertices in drafted.held.items()}
    path = write(
        tmp_path, vertices=drafted.positions, faces=drafted.faces, uv=drafted.uv, uv_faces=drafted.faces,
        stitches=drafted.stitches, **labels,
    )  # fmt: skip
    read = read_mesh_garment(path)
    assert read.flat and np.array_equal(read.faces, drafted.faces)
    assert np.allclose(read.positions, drafted.positions)
    edges = np.roll(drafted.rest_corners, -1, axis=1) - drafted.rest_corners
    assert np.allclose(
        np.abs(np.roll(read.rest_corners, -1, axis=1) - read.rest_corners), np.abs(edges), atol=1e-6
    )
    pairs = {tuple(sorted(pair)) for pair in drafted.stitches.tolist()}
    assert {tuple(sorted(pair)) for pair in read.stitches.tolist()} == pairs
    assert {label: set(found) for label, found in read.held.items()} == {
        label: set(found) for label, found in drafted.held.items()
    }
    assert {role: set(found) for role, found in read.edges.items()} == {
        role: set(found) for role, found in drafted.edges.items()
    }


def test_midpoints_of_sewn_edges_are_sewn_too(tmp_path: Path) -> None:
    vertices, faces, uv = sheet(3, 0.4, 0.0)
    both = np.concatenate([vertices, vertices + np.array([0.0, 0.1, 0.0])])
    path = write(
        tmp_path, vertices=both, faces=np.concatenate([faces, faces + 9]), uv=np.concatenate([uv, uv]),
        uv_faces=np.concatenate([faces, faces + 9]), stitches=[[0, 9], [1, 10], [2, 11]],
    )  # fmt: skip
    read = read_mesh_garment(path, edge_length=0.05)
    assert len(read.positions) > 100 and len(read.stitches) > 6
    apart = read.positions[read.stitches[:, 0]] - read.positions[read.stitches[:, 1]]
    assert np.allclose(np.abs(apart), (0.0, 0.1, 0.0))
    assert read.seam_names == ("piece 0 - piece 1",)


@pytest.fixture(scope="module")
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[DressedGarment]:
    """Make a sheet over a ball that moves aside; its corner is pinned and led upwards."""
    folder = tmp_path_factory.mktemp("film")
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.25)
    offsets = np.linspace(0.0, 0.02, 4)
    np.savez(
        folder / "ball.npz", faces=ball.faces, fps=24.0,
        vertices=np.stack([ball.vertices + np.array([away, 0.3, 0.0]) for away in offsets]),
    )  # fmt: skip
    vertices, faces, uv = sheet(9, 0.7, 0.56)
    path = write(
        folder, vertices=vertices, faces=faces, uv=uv, uv_faces=faces, pins=np.arange(81) == 0,
        motion=np.stack([vertices + np.array([0.0, away, 0.0]) for away in offsets]), fps=24.0,
        polygon=np.arange(128) // 2,
    )  # fmt: skip
    scene = Scene(
        garments=[Garment(path)], avatar=AvatarFile(path=folder / "ball.npz", units="m", up="y"),
        quality="preview", remesh=SizingOptions(size_min=0.05, size_max=0.4, refine_angle=0.6),
    )  # fmt: skip
    recorded: list[DressedGarment] = []
    result = dress(scene, record=lambda _, garments: recorded.append(garments[0]))
    assert result.status != "failed"
    return recorded


def test_every_frame_is_recorded(frames: list[DressedGarment]) -> None:
    assert len(frames) == 4 and frames[-1].velocities is not None and frames[-1].velocities.any()


def test_origin_follows_through_remeshing(frames: list[DressedGarment]) -> None:
    """The pattern coordinates that the engine carries are those that follow from the origin."""
    _, _, uv = sheet(9, 0.7, 0.56)
    for garment in frames:
        assert garment.origin is not None and len(garment.faces) != 128
        assert np.allclose(garment.origin.at_vertices(uv), garment.uv, atol=1e-9)
        assert garment.origin.face.min() >= 0 and garment.origin.face.max() < 64


def test_pins_are_led(frames: list[DressedGarment]) -> None:
    start = np.array([-0.35, 0.56, -0.35])
    for garment, away in zip(frames, np.linspace(0.0, 0.02, 4), strict=True):
        distance = np.linalg.norm(garment.positions - (start + np.array([0.0, away, 0.0])), axis=1)
        assert distance.min() < 1e-5


def test_weights_of_pins_that_give_way(tmp_path: Path) -> None:
    """A row of vertices with weights 1, 1, 0, 0, 0.4, 0.8, 1: only what is beside a weak pin is drawn."""
    weights = np.array([1.0, 1.0, 0.0, 0.0, 0.4, 0.8, 1.0])
    u, v = (grid.ravel() for grid in np.meshgrid(np.arange(7.0), np.arange(2.0)))
    vertices = 0.1 * np.column_stack([u, np.zeros(14), v])
    first = np.arange(6)
    faces = np.concatenate(
        [np.stack([first, first + 7, first + 1], 1), np.stack([first + 1, first + 7, first + 8], 1)]
    )
    arrays = {"vertices": vertices, "faces": faces, "pins": np.tile(weights, 2)}
    read = read_mesh_garment(write(tmp_path, pin_stiffness=500.0, **arrays), edge_length=0.04)
    assert read.pull is not None and len(read.pull) > 40
    place = read.positions[:, 0]
    wanted = 500.0 * np.interp(place, 0.1 * np.arange(3.0, 7.0), [0.0, 0.4, 0.8, 1.0])
    wanted[place < 0.3] = 0.0
    assert read.pull == pytest.approx(wanted, abs=1e-5)
    assert np.array_equal(read.pinned, np.flatnonzero((place < 0.1 + 1e-9) | (place > 0.6 - 1e-9)))
    hard = np.where(arrays["pins"] == 1.0, 1.0, 0.0)
    assert read_mesh_garment(write(tmp_path, **(arrays | {"pins": hard}))).pull is None
    assert read_mesh_garment(write(tmp_path, pin_stiffness=0.0, **arrays)).pull is None


def test_pins_that_give_way_are_led(tmp_path: Path) -> None:
    """The sheet sinks beneath its goals, hanging in the air, by its weight over their stiffness."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    offsets = np.linspace(0.0, 0.02, 4)
    np.savez(tmp_path / "ball.npz", faces=ball.faces, fps=24.0, vertices=np.stack([ball.vertices] * 4))
    vertices, faces, uv = sheet(9, 0.7, 0.3)
    path = write(
        tmp_path, vertices=vertices, faces=faces, uv=uv, uv_faces=faces, pins=np.full(81, 0.5), fps=24.0,
        motion=np.stack([vertices + np.array([away, 0.0, 0.0]) for away in offsets]), pin_stiffness=4000.0,
    )  # fmt: skip
    scene = Scene(
        garments=[Garment(path, fabric="denim-12oz")], quality="preview", edge_length=0.05, remesh=False,
        avatar=AvatarFile(path=tmp_path / "ball.npz", units="m", up="y"),
    )  # fmt: skip
    recorded: list[DressedGarment] = []
    assert dress(scene, record=lambda _, garments: recorded.append(garments[0])).status == "converged"
    start = recorded[0].positions
    density = recorded[0].fabric.areal_density
    assert start[:, 1] == pytest.approx(0.3 - 9.81 * density / 2000.0, abs=2e-5)
    moved = recorded[-1].positions - start
    assert moved[:, 0] == pytest.approx(0.02, abs=0.01) and np.abs(moved[:, 1:]).max() < 1e-3


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"faces": [[0, 1, 2]]}, "lacks the array `vertices`"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 3]]}, "refers to a vertex that does not exist"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "pin": [1]}, "unknown array `pin`"),
        ({"vertices": np.eye(2), "faces": [[0, 1, 2]]}, "`vertices` must hold numbers of shape"),
        ({"vertices": np.eye(3) * np.nan, "faces": [[0, 1, 2]]}, "NaN"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "uv": np.eye(2)}, "belong together"),
        (
            {"vertices": np.eye(3), "faces": [[0, 1, 2]], "motion": np.zeros((1, 3, 3)), "fps": 24.0},
            "two frames",
        ),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "pins": [0.0, 1.5, 0.0]}, "weight between 0 and 1"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "pins": [1.0]}, "for every vertex"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "pin_stiffness": -1.0}, "between 0 and 1e"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2.5]]}, "`faces` must hold whole numbers"),
        (
            {"vertices": np.eye(3), "faces": [[0, 1, 2]], "uv": np.eye(2), "uv_faces": [[0, 1, 2]]},
            "`uv_faces` has a negative number, or a row of `uv` that does not exist",
        ),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "panel": [0, 1]}, "`panel` has 2 rows, but"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "panel": [-1]}, "`panel` has a negative number"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "stitches": [[0, 3]]}, "row of `vertices` that"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "held_hem": [3]}, "`held_hem` has a neg"),
        ({"vertices": np.eye(3), "faces": [[0, 1, 2]], "fps": 0.0}, "fps must be greater than zero"),
    ],
)  # fmt: skip
def test_mistakes_are_named(arrays: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        read_mesh_garment(write(tmp_path, **arrays))


def test_all_faces_at_fault_are_listed(tmp_path: Path) -> None:
    """By their polygons, of which each is two triangles: a strip with one side."""
    count = 12
    angle = 2.0 * np.pi * np.arange(count) / count
    reach = np.concatenate([1.0 + w * np.cos(angle / 2.0) for w in (-0.2, 0.2)])
    height = np.concatenate([w * np.sin(angle / 2.0) for w in (-0.2, 0.2)])
    vertices = np.column_stack([reach * np.cos(np.tile(angle, 2)), height, reach * np.sin(np.tile(angle, 2))])
    ends = [(k, (k + 1) % count, count + k, count + (k + 1) % count) for k in range(count)]
    ends[-1] = (count - 1, count, 2 * count - 1, 0)
    faces = [face for a, b, c, d in ends for face in ((a, b, c), (b, d, c))]
    path = write(tmp_path, vertices=vertices, faces=faces, polygon=np.arange(2 * count) // 2 + 100)
    with pytest.raises(InputError, match="Moebius") as caught:
        read_mesh_garment(path)
    assert len(caught.value.faces) and set(caught.value.faces) <= set(range(100, 100 + count))


def test_dirty_faces_are_mended_and_still_known_by_the_file(tmp_path: Path) -> None:
    """A doubled face, a needle, and a cap on the side of another face; corners are those of the file."""
    vertices, faces, uv = sheet(5, 0.4, 0.0)
    a, b, c = faces[10]
    # A vertex on the middle of one side: its face on the other side stays whole, and a cap fills the slit.
    middle, twin = len(vertices), len(vertices) + 1
    vertices = np.concatenate([vertices, [0.5 * (vertices[a] + vertices[b]), vertices[c]]])
    uv = np.concatenate([uv, [0.5 * (uv[a] + uv[b]), uv[c]]])
    split = [(a, middle, c), (middle, b, c)]
    dirty = np.concatenate([np.delete(faces, 10, axis=0), split, [(a, b, middle), faces[3], (c, twin, b)]])
    pins = np.zeros(len(vertices))
    pins[[a, b, middle]] = 1.0
    polygon = np.arange(len(dirty)) + 100
    clean = read_mesh_garment(write(tmp_path, vertices=vertices, faces=np.delete(faces, 10, axis=0)))
    path = write(tmp_path, vertices=vertices, faces=dirty, uv=uv, uv_faces=dirty, polygon=polygon, pins=pins)
    read = read_mesh_garment(path)
    count = len(faces) - 1
    assert f"face {100 + count + 3} is left out: other faces lie there" in read.notes
    assert f"2 faces ({100 + count + 2}, {100 + count + 4}) are mended: no area" in read.notes
    assert read.origin is not None and clean.origin is not None
    first, second = (read.rest_corners[:, k] - read.rest_corners[:, 0] for k in (1, 2))
    area = 0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    assert area.sum() == pytest.approx(0.16) and area.min() > 1e-4
    # Coordinates of every vertex follow from those of the file's corners.
    assert read.origin.first[-1] == len(uv)
    assert np.allclose(read.origin.at_vertices(uv), read.uv)
    assert np.allclose(read.origin.at_vertices(vertices), read.positions)
    assert read.origin.face.min() >= 100 and set(read.origin.face) <= set(polygon)
    places = {tuple(np.round(read.positions[vertex], 9) + 0.0) for vertex in read.pinned}
    assert places == {tuple(np.round(vertices[vertex], 9) + 0.0) for vertex in (a, b, middle)}


def test_a_file_of_faces_without_area_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no face has an area"):
        read_mesh_garment(write(tmp_path, vertices=np.zeros((3, 3)), faces=[[0, 1, 2]]))


def test_sewing_edge_to_a_vertex_without_a_face(tmp_path: Path) -> None:
    vertices, faces, _ = sheet(3, 0.5, 0.0)
    vertices = np.concatenate([vertices, [[0.0, 1.0, 0.0]]])
    with pytest.raises(InputError, match="vertex 9, which has no face"):
        read_mesh_garment(write(tmp_path, vertices=vertices, faces=faces, stitches=[[0, 9]]))
