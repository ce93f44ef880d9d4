"""What a scene accepts from Python, and what it refuses at once with a true sentence."""

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.garment.fabrics import checked_fabric, fabric, fabrics
from toile.dressing.pattern.garmentcode_write import garmentcode_document
from toile.dressing.pattern.pattern import Edge, Panel, Pattern, Stitch
from toile.dressing.run.air import Air
from toile.dressing.run.scene import AvatarFile, Garment, MannequinSize, Scene
from toile.dressing.run.scene_file import load_scene
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError
from toile.remesh.sizing.sizing import SizingOptions


def test_numbers_may_be_of_any_real_type() -> None:
    scene = Scene(
        garments=Garment("tshirt", walls=np.int64(1), warp_angle=np.float32(45.0), pins=np.array([3, 4])),
        avatar=MannequinSize(height=np.float64(1.75)), gravity=np.float32(9.5), max_frames=np.int64(3),
        edge_length=Fraction(1, 64), friction=np.float16(0.5), ground=np.float32(0.25),
        friction_between={("a", "body"): np.float32(0.5)}, remesh=np.bool_(False),  # type: ignore[arg-type]
        air=Air(velocity=np.array([0, 0, 5.0]), gusts=np.float32(0.125), seed=np.int32(3)),
    )  # fmt: skip
    assert (scene.gravity, scene.max_frames, scene.edge_length) == (9.5, 3, 0.015625)
    assert (scene.friction, scene.ground, scene.remesh) == (0.5, 0.25, False)
    assert [type(value) for value in (scene.gravity, scene.max_frames, scene.ground)] == [float, int, float]
    assert scene.air is not None and scene.air.velocity == (0.0, 0.0, 5.0) and scene.air.gusts == 0.125
    assert scene.garments[0].pins == (3, 4) and scene.garments[0].warp_angle == 45.0
    assert SizingOptions(size_min=np.float32(0.25), size_max=1).size_min == 0.25
    silk = fabric("silk-charmeuse")
    assert Fabric(**{**vars(silk), "shear": np.int64(60)}) == silk


def test_convenient_spellings_are_the_long_ones(tmp_path: Path) -> None:
    long = Scene(garments=(Garment("tshirt"),), avatar=AvatarFile(path=tmp_path / "b.obj"), formats=("vtu",))
    short = Scene(garments="tshirt", avatar=str(tmp_path / "b.obj"), formats="vtu")
    assert short == long
    assert Garment("tshirt", pins="hem").pins == ("hem",)
    assert AvatarFile(path="b.glb", only="Body*") == AvatarFile(path=Path("b.glb"), only=("Body*",))


def test_a_pattern_may_be_a_dictionary() -> None:
    square = ((0.0, 0.0), (0.4, 0.0), (0.4, 0.6), (0.0, 0.6))
    sides = tuple(Edge(start, (start + 1) % 4) for start in range(4))
    panels = tuple(Panel(name=name, vertices=square, edges=sides) for name in ("front", "back"))
    pattern = Pattern(name="garment", panels=panels, stitches=(Stitch("front", 1, "back", 3),))
    document = garmentcode_document(pattern)
    assert Garment(document).source == Garment(pattern).source
    del document["pattern"]["panels"]["front"]["edges"]
    with pytest.raises(InputError, match="panel 'front': 'edges' must be"):
        Garment(document)


def scene(**fields: object) -> Scene:
    return Scene(**({"garments": "tshirt"} | fields))  # type: ignore[arg-type]


def shirt(**fields: object) -> Garment:
    return Garment(**({"source": "tshirt"} | fields))  # type: ignore[arg-type]


def body(**fields: object) -> AvatarFile:
    return AvatarFile(**({"path": "a.glb"} | fields))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("make", "said", "field"),
    [
        (lambda: scene(max_frames=2.5), "max_frames must be a whole number, got 2.5", "max_frames"),
        (lambda: scene(max_frames=True), "max_frames must be a whole number, got True", "max_frames"),
        (lambda: scene(gravity="9"), "gravity must be a number, got '9'", "gravity"),
        (lambda: scene(gravity=np.nan), "gravity must be a number, got nan", "gravity"),
        (lambda: scene(remesh="no"), "remesh must be True, False or SizingOptions, got 'no'", "remesh"),
        (lambda: scene(air=(0, 0, 5)), "air must be an Air, such as", "air"),
        (lambda: scene(avatar=np.eye(3)), "avatar must be an Avatar, a file or", "avatar"),
        (lambda: scene(fabrics={"a": 5}), "fabrics: 'a' must be a Fabric, got 5", "fabrics"),
        (lambda: scene(fabric=5), "fabric must be the name of a fabric or a Fabric", "fabric"),
        (lambda: scene(quality=3), "quality must be a text, got 3", "quality"),
        (lambda: scene(garments=[]), "the scene has no garment", "garments"),
        (lambda: scene(garments=7), "garments must be a list of garments, got int", "garments"),
        (lambda: shirt(source=None), "a garment is the name of a pattern, a file, .* got None", "source"),
        (lambda: shirt(warp_angle=-np.inf), "warp_angle must be a finite number of degrees", "warp_angle"),
        (lambda: shirt(pins=[1.5]), "pins are edge labels and numbers of vertices", "pins"),
        (lambda: shirt(self_contact="no"), "self_contact must be True or False", "self_contact"),
        (lambda: shirt(walls=3), "walls of a garment are 1 or 2, got 3", "walls"),
        (lambda: shirt(seams=3), "seams must be a list of texts, got 3", "seams"),
        (lambda: body(path=3), "path must be a path, got 3", "path"),
        (lambda: body(fps="24"), "fps must be a number, got '24'", "fps"),
        (lambda: MannequinSize(height=np.array([1, 2])), "height must be a number, got array", "height"),
        (lambda: Fabric(**{**vars(fabric("canvas")),
         "shear": "60"}), "shear must be a finite number", "fabric.shear"),
    ],
)  # fmt: skip
def test_wrong_types_are_refused_at_construction(make: Callable[[], object], said: str, field: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        make()
    assert caught.value.field == field


UNITS = [
    ("thickness", 0.8, "in mm?"), ("thickness", 800.0, "in um?"), ("areal_density", 187.0, "in g/m^2?"),
    ("areal_density", 5.5, "in oz/yd^2?"), ("bending_warp", 5.8, "in uN m?"),
    ("bending_bias", 0.05, "in gf cm^2/cm?"),
    ("stretch_weft", 2.8, "in kN/m?"), ("friction_body", 35.0, "in percent?"),
    ("compression", 2.0, "in percent?"),
    ("damping", 50.0, "in ms?"), ("stretch_warp", 1e-300, "must lie between 5 and 1e+06 N/m, got 1e-300"),
    ("areal_density", 1e-300, "must lie between 0.001 and 5 kg/m^2"),
    ("thickness", 9e18, "between 1e-05 and 0.02 m"), ("shear", 1e9, "must lie between 0 and 1e+06 N/m"),
    ("friction_body", 1e9, "must lie between 0 and 10, got 1e+09"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value", "said"), UNITS)
def test_fabrics_in_the_wrong_unit_are_refused_everywhere(
    tmp_path: Path, name: str, value: float, said: str
) -> None:
    wrong = Fabric(**{**vars(fabric("cotton-interlock")), name: value})
    for make in (
        lambda: checked_fabric(wrong),
        lambda: Garment("tshirt", fabric=wrong),
        lambda: Scene(garments="tshirt", fabrics={"mine": wrong}),
        lambda: Scene(garments=[Garment("tshirt", panel_fabrics={"front": wrong})]),
    ):
        with pytest.raises(InputError) as caught:
            make()
        assert f"fabric 'cotton-interlock': {name} " in str(caught.value) and said in str(caught.value)
        assert caught.value.field == f"fabric.{name}"
    file = tmp_path / "scene.toml"
    file.write_text(
        "[[garment]]\nsource = 'tshirt'\nfabric = 'f'\n[fabric.f]\nlike = 'cotton-interlock'\n"
        f"{name} = {value}\n"
    )
    with pytest.raises(InputError) as caught:
        load_scene(file)
    assert f"scene.toml, line 6: fabric 'f': {name} " in str(caught.value) and said in str(caught.value)


def test_presets_stay_as_they_are() -> None:
    fabrics()["evil"] = fabric("canvas")
    assert "evil" not in fabrics()
