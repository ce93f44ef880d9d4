"""Seams between runs and fabrics of single panels, in scenes and scene files."""

from pathlib import Path

import pytest

from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.garment.fabrics import fabric
from toile.dressing.pattern.drafts import built_in
from toile.dressing.pattern.garmentcode_write import write_garmentcode
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.run.load_garment import load_garment
from toile.dressing.run.resolved_scene import resolve
from toile.dressing.run.scene import Garment, Scene
from toile.dressing.run.scene_file import load_scene
from toile.dressing.wear.assemble_cloth import assemble_cloth
from toile.geometry.errors import InputError


@pytest.fixture(scope="module")
def form() -> DressForm:
    return DressForm(mannequin())


@pytest.fixture
def unsewn(form: DressForm, tmp_path: Path) -> Path:
    """The built-in T-shirt without its side seams, which a scene sews."""
    shirt = built_in("tshirt", form.measurements)
    kept = [s for s in shirt.stitches if {s.panel_a, s.panel_b} != {"front", "back"}]
    assert len(kept) == len(shirt.stitches) - 4
    path = tmp_path / "shirt_specification.json"
    write_garmentcode(Pattern(name="shirt", panels=shirt.panels, stitches=tuple(kept)), path)
    return path


def test_seams_of_a_scene_file_are_sewn(form: DressForm, unsewn: Path, tmp_path: Path) -> None:
    shirt = built_in("tshirt", form.measurements)
    seams = [
        f"{s.panel_a}.{s.edge_a} = {s.panel_b}.{s.edge_b}"
        for s in shirt.stitches
        if {s.panel_a, s.panel_b} == {"front", "back"}
    ]
    file = tmp_path / "scene.toml"
    file.write_text(f'[[garment]]\nsource = "{unsewn.name}"\nseams = {seams!r}\n'.replace("'", '"'))
    scene = resolve(load_scene(file))
    mesh = load_garment(scene.garments[0], form, scene.sewing[0])
    whole = load_garment(resolve(Scene(garments=["tshirt"])).garments[0], form, scene.sewing[0])
    assert sorted(map(tuple, mesh.stitches.tolist())) == sorted(map(tuple, whole.stitches.tolist()))


def test_a_seam_that_does_not_exist_is_refused(form: DressForm, unsewn: Path) -> None:
    scene = resolve(Scene(garments=[Garment(unsewn, seams=["front.1 = bakc.1"])]))
    with pytest.raises(InputError, match=r"unknown panel 'bakc'.*back"):
        load_garment(scene.garments[0], form, scene.sewing[0])


def test_a_panel_may_be_of_another_fabric(form: DressForm, tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(
        '[[garment]]\nsource = "tshirt"\nfabric = "cotton-interlock"\n'
        'panel_fabrics = { back = "denim-12oz" }\n'
    )
    scene = resolve(load_scene(file))
    mesh = load_garment(scene.garments[0], form, scene.sewing[0])
    cloth = assemble_cloth([(mesh, scene.garments[0].fabric)], [])
    assert [entry.name for entry in cloth.fabrics] == ["cotton-interlock", "denim-12oz"]
    assert (cloth.fabric == (mesh.panel == mesh.panel_names.index("back"))).all()
    assert cloth.fabrics[1] == fabric("denim-12oz")


def test_unknown_panels_and_fabrics_are_named(form: DressForm, tmp_path: Path) -> None:
    scene = resolve(Scene(garments=[Garment("tshirt", panel_fabrics={"bakc": "denim-12oz"})]))
    with pytest.raises(InputError, match=r"panel_fabrics: unknown panel 'bakc'.*back"):
        load_garment(scene.garments[0], form, scene.sewing[0])
    file = tmp_path / "scene.toml"
    file.write_text('[[garment]]\nsource = "tshirt"\npanel_fabrics = { back = "denmi" }\n')
    with pytest.raises(InputError, match="line 3: unknown fabric 'denmi'"):
        load_scene(file)
    with pytest.raises(InputError, match="unknown fabric 'denmi'"):
        resolve(Scene(garments=[Garment("tshirt", panel_fabrics={"back": "denmi"})]))
