"""Parts of a file that are no body are left out and named; the user may say otherwise."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from tests.dressing.files.gltf_writer import Glb
from toile.dressing.body.avatar import load_avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.files.writers.obj import obj_bytes
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

BODY = mannequin()
Mesh = tuple[Float, Int]
SQUARE: Int = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def obj(path: Path, **parts: Mesh) -> Path:
    """Write the mannequin and further groups."""
    groups = {"body": (BODY.vertices, BODY.faces), **parts}
    lines, count = [], 0
    for name, (vertices, faces) in groups.items():
        lines.append(f"g {name.replace('__', '-')}")
        lines += ["v {:.9f} {:.9f} {:.9f}".format(*vertex) for vertex in vertices]
        lines += ["f {} {} {}".format(*face) for face in faces + count + 1]
        count += len(vertices)
    path.write_text("\n".join(lines))
    return path


def box(low: list[float], high: list[float]) -> Mesh:
    """A closed box."""
    mesh = trimesh.creation.box(bounds=[low, high])
    return np.asarray(mesh.vertices), np.asarray(mesh.faces, np.int32)


def floor(half: float) -> Mesh:
    """A square on the floor."""
    corners = np.array([[-half, 0, -half], [-half, 0, half], [half, 0, half], [half, 0, -half]])
    return corners, SQUARE


def test_helpers_joints_and_hair_are_left_out_by_name(tmp_path: Path) -> None:
    skirt = box([-0.4, 0.3, -0.4], [0.4, 0.9, 0.4])
    path = obj(
        tmp_path / "mh.obj", helper__skirt=skirt, joint__head=box([0, 1.6, 0], [0.01, 1.61, 0.01]),
        long_hair=box([-0.1, 1.2, -0.2], [0.1, 1.7, -0.1]),
    )  # fmt: skip
    avatar = load_avatar(path)
    assert len(avatar.faces) == len(BODY.faces)
    assert any(
        "3 parts that are no body by name left out: helper-skirt, joint-head" in n for n in avatar.notes
    )
    with_skirt = load_avatar(path, only=["body", "helper-*"])
    assert with_skirt.vertices[:, 2].max() > 0.39
    assert "Parts read: body, helper-skirt." in with_skirt.notes


@pytest.mark.parametrize("half", [0.4, 5.0])
def test_a_floor_is_left_out_whatever_its_name_and_size(half: float, tmp_path: Path) -> None:
    avatar = load_avatar(obj(tmp_path / "b.obj", Plane001=floor(half)))
    assert len(avatar.faces) == len(BODY.faces) and avatar.metres_per_unit == 1.0
    assert any("1 flat part was left out" in note for note in avatar.notes)
    slab = load_avatar(obj(tmp_path / "s.obj", Cube=box([-half, -0.02, -half], [half, 0.0, half])))
    assert len(slab.faces) == len(BODY.faces)


def test_cards_of_hair_are_left_out_and_eyes_are_united(tmp_path: Path) -> None:
    x, y = np.meshgrid(np.linspace(-0.05, 0.05, 6), np.linspace(1.4, 1.7, 12))
    card = np.column_stack([x.ravel(), y.ravel(), -0.13 - 0.3 * x.ravel() ** 2])
    k = np.arange(11)[:, None] * 6 + np.arange(5)
    quads = np.stack([k, k + 1, k + 7, k + 6], axis=-1).reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.012)
    eye = np.asarray(ball.vertices) + np.array([0.03, 1.6, 0.06]), np.asarray(ball.faces, np.int32)
    avatar = load_avatar(obj(tmp_path / "b.obj", strands=(card, faces), eye=eye))
    assert any(
        "1 sheets that enclose no volume (cards of hair, lashes) were left out" in n for n in avatar.notes
    )
    assert any("2 closed parts were united" in note for note in avatar.notes)


@pytest.mark.parametrize(("turn", "shift"), [(False, 0.0), (True, 0.0), (False, 2e-7), (True, 2e-7)])
def test_a_second_copy_of_every_face_is_left_out(turn: bool, shift: float, tmp_path: Path) -> None:
    """Double-sided exports have every face twice, back to back, with vertices of their own, rounded anew."""
    copy = BODY.vertices + shift, BODY.faces[:, ::-1] if turn else BODY.faces
    avatar = load_avatar(obj(tmp_path / "b.obj", inner=copy))
    assert len(avatar.faces) == len(BODY.faces)
    assert (
        f"{len(BODY.faces)} faces that lie on others, the same or turned over, were left out." in avatar.notes
    )


def test_a_double_sided_body_of_several_materials_is_one_body(tmp_path: Path) -> None:
    glb = Glb()
    positions = [glb.numbers(BODY.vertices) for _ in range(2)]
    primitives = []
    for k, part in enumerate(np.array_split(BODY.faces, 3)):
        glb.add("materials", name=f"m{k}")
        for side, faces in enumerate((part, part[:, ::-1])):
            indices = glb.numbers(faces.ravel(), "<u4")
            primitives.append(
                {"attributes": {"POSITION": positions[side]}, "indices": indices, "material": k}
            )
    glb.node(mesh=glb.add("meshes", primitives=primitives), name="eve")
    avatar = load_avatar(glb.write(tmp_path / "b.glb"))
    assert len(avatar.faces) == len(BODY.faces) and len(avatar.vertices) == len(BODY.vertices)


def test_parts_are_chosen_by_name(tmp_path: Path) -> None:
    path = obj(tmp_path / "b.obj", Backpack=box([-0.1, 1.0, -0.3], [0.1, 1.4, -0.1]))
    assert load_avatar(path).vertices[:, 2].min() < -0.29
    for choice in ({"without": ["backpack"]}, {"only": ["Body"]}):
        assert len(load_avatar(path, **choice).faces) == len(BODY.faces)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"b\.obj: has no part 'coat'; it has body, Backpack"):
        load_avatar(path, without=["coat"])
    with pytest.raises(InputError, match=r"b\.obj: no part remains"):
        load_avatar(path, without=["*"])
    (tmp_path / "plain.obj").write_bytes(obj_bytes(BODY.vertices, BODY.faces, comment=""))
    with pytest.raises(InputError, match=r"has no part 'coat'; its parts have no names"):
        load_avatar(tmp_path / "plain.obj", only=["coat"])
