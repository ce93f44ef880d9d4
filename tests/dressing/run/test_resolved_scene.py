"""What a scene comes to: every choice made, mistakes named, before anything is read."""

import pickle
from pathlib import Path
from typing import Any

import pytest

from toile.dressing.garment.fabrics import DEFAULT_FABRIC, fabric
from toile.dressing.pattern.sewing_edges import sewing_edges
from toile.dressing.run.air import Air
from toile.dressing.run.quality import quality_preset
from toile.dressing.run.resolved_scene import SEWING_FINENESS, resolve
from toile.dressing.run.scene import AvatarFile, Garment, MannequinSize, Scene
from toile.geometry.errors import InputError
from toile.remesh.sizing.sizing import SizingOptions


def test_defaults_are_the_numbers_of_the_quality() -> None:
    scene = resolve(Scene(garments=[Garment("T-shirt")]))
    standard = quality_preset("standard")
    (shirt,) = scene.garments
    assert (shirt.name, shirt.source, shirt.fabric) == ("tshirt", "tshirt", fabric(DEFAULT_FABRIC))
    assert scene.avatar == MannequinSize()
    assert (scene.quality, scene.tolerance) == ("standard", standard.tolerance)
    assert (scene.max_frames, scene.edge_length) == (standard.max_frames, standard.edge_length)
    assert scene.sizing == standard.sizing(standard.edge_length)
    assert list(scene.sewing) == sewing_edges(standard.edge_length, scene.sizing.size_max)
    assert (scene.air, scene.friction, scene.friction_between) == (None, None, {})


def test_what_the_scene_says_wins() -> None:
    sizing = SizingOptions(size_min=0.02, size_max=0.1, refine_angle=0.5)
    air = Air(velocity=(0.0, 0.0, 3.0))
    scene = resolve(
        Scene(garments=[Garment("tshirt")], edge_length=0.03, max_frames=7, remesh=sizing, air=air)
    )
    assert (scene.max_frames, scene.edge_length, scene.sizing) == (7, 0.03, sizing)
    assert list(scene.sewing) == sewing_edges(0.02, 0.1)
    assert scene.air == air.flow()


def test_a_mesh_that_stays_is_sewn_as_asked_for_then_finer() -> None:
    scene = resolve(Scene(garments=[Garment("tshirt")], edge_length=0.03, remesh=False))
    assert scene.sizing is None
    assert [edges.length for edges in scene.sewing] == [0.03 * share for share in SEWING_FINENESS]


def test_garments_have_names_and_fabrics_of_their_own(tmp_path: Path) -> None:
    file = tmp_path / "coat.obj"
    file.write_text("v 0 0 0\n")
    mine = fabric("canvas")
    garments = [
        Garment("tshirt", pins=("left_collar",), warp_angle=45.0),
        Garment("tshirt", fabric="mine"),
        Garment(str(file), fabric=fabric("denim-12oz"), units="cm", up="z", self_contact=False),
    ]
    pairs = {("ponte-roma", "body"): 0.5, ("denim-12oz", "canvas"): 0.2}
    scene = resolve(
        Scene(garments=garments, fabric="ponte-roma", fabrics={"mine": mine}, friction_between=pairs)
    )
    assert [garment.name for garment in scene.garments] == ["tshirt", "tshirt_2", "coat"]
    assert [garment.fabric.name for garment in scene.garments] == ["ponte-roma", "canvas", "denim-12oz"]
    assert (scene.garments[0].pins, scene.garments[0].warp_angle) == (("left_collar",), 45.0)
    coat = scene.garments[2]
    assert (coat.source, coat.units, coat.up, coat.self_contact) == (file, "cm", "z", False)
    assert scene.friction_between == {
        frozenset(("ponte-roma", "body")): 0.5, frozenset(("denim-12oz", "canvas")): 0.2
    }  # fmt: skip
    assert pickle.loads(pickle.dumps(scene)) == scene


@pytest.mark.parametrize(
    ("options", "message", "field", "garment"),
    [
        ({"fabric": "silk"}, "unknown fabric 'silk'; did you mean", "fabric", None),
        ({"garments": [Garment("tshirt", fabric="silk")]}, "unknown fabric", "fabric", "tshirt"),
        ({"garments": [Garment("gone.obj", name="coat")]}, "gone.obj: garment file not", "source", "coat"),
        (
            {"garments": [Garment("tshrt")]},
            "unknown garment 'tshrt'; did you mean 'tshirt'",
            "source",
            "tshrt",
        ),
        ({"friction_between": {("silk", "body"): 0.1}}, "unknown fabric 'silk'", "friction_between", None),
        ({"avatar": 3}, "avatar must be an Avatar, a file or a mannequin size, got 3", "avatar", None),
    ],
)
def test_mistakes_are_named(options: dict[str, Any], message: str, field: str, garment: str | None) -> None:
    with pytest.raises(InputError, match=message) as raised:
        resolve(
            Scene(**{"garments": [Garment("tshirt")], "avatar": AvatarFile(path=Path("unread")), **options})
        )
    assert (raised.value.field, raised.value.garment) == (field, garment)
