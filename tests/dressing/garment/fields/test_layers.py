"""Layers that belong together: what they are as one fabric, where they lie, how a strip with one bends."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from tests.dressing.garment.fields.test_mesh_parts import meshed
from tests.engine.adapt.test_remeshing import FINE, OPTIONS
from toile.dressing.garment.fabrics import fabric
from toile.dressing.garment.fields.field import Parts
from toile.dressing.garment.fields.layer import Layer
from toile.dressing.garment.fields.layered_fabric import layered
from toile.dressing.garment.fields.mesh_parts import mesh_with_parts
from toile.dressing.pattern.pattern import Edge, Panel, Pattern
from toile.dressing.pattern.sewing_edges import SewingEdges
from toile.dressing.run.resolved_scene import resolve
from toile.dressing.run.scene import Garment, Scene
from toile.dressing.run.scene_file import load_scene
from toile.dressing.wear.assemble_cloth import assemble_cloth
from toile.engine.adapt.remeshing import remeshed
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fabric_curves import curve_tables
from toile.engine.cloth.stretch_curve import tension_at
from toile.engine.step.cloth_forces import cloth_stepper
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError
from toile.geometry.stage_clock import StageClock
from toile.studies.scenes.motion import free_options
from toile.studies.validation.heavy_strip import SETTLED

SHELL = Fabric(
    name="shell", areal_density=0.12, thickness=3e-4, bending_warp=4e-6, bending_weft=3e-6, bending_bias=2e-6,
    stretch_warp=4000.0, stretch_weft=2500.0, shear=400.0, friction_body=0.3,
)  # fmt: skip
FUSING = replace(
    SHELL, name="fusing", areal_density=0.05, thickness=2e-4, bending_warp=2e-6, bending_weft=1e-6,
    bending_bias=1e-6, stretch_warp=1000.0, stretch_weft=800.0, shear=300.0, friction_body=0.5,
)  # fmt: skip


def test_layers_that_slide_add_up() -> None:
    both = layered(SHELL, [Layer(fabric=FUSING)])
    added = ("areal_density", "thickness", "stretch_warp", "stretch_weft", "shear")
    for name in (*added, "bending_warp", "bending_weft", "bending_bias"):
        assert getattr(both, name) == pytest.approx(getattr(SHELL, name) + getattr(FUSING, name), rel=1e-15)
    assert both.friction_body == 0.5 and both.friction_self == SHELL.friction_self and both.name == "shell"
    assert layered(SHELL, [Layer()]).areal_density == 2 * SHELL.areal_density


def test_a_bonded_layer_adds_that_of_the_sandwich() -> None:
    """k1 k2/(k1 + k2) d^2: the least of k1 z1^2 + k2 z2^2 over the height of the neutral plane."""
    apart = 0.5 * (SHELL.thickness + FUSING.thickness)
    planes = np.linspace(0.0, apart, 100_001)
    least = (4000.0 * planes**2 + 1000.0 * (apart - planes) ** 2).min()
    both = layered(SHELL, [Layer(fabric=FUSING, bond=1.0)])
    assert both.bending_warp == pytest.approx(6e-6 + least, rel=1e-8)
    half = layered(SHELL, [Layer(fabric=FUSING, bond=0.5)])
    assert half.bending_warp == pytest.approx(6e-6 + 0.5 * least, rel=1e-8)


def test_bonded_plates_are_one_plate_of_their_whole_thickness() -> None:
    """Of n isotropic plates without Poisson's ratio, D = k t^2/12: n^3 times as stiff."""
    k, t = 3000.0, 4e-4
    plate = replace(
        SHELL, thickness=t, stretch_warp=k, stretch_weft=k, shear=0.5 * k, bending_warp=k * t * t / 12,
        bending_weft=k * t * t / 12, bending_bias=k * t * t / 12,
    )  # fmt: skip
    for count in (2, 3, 4):
        whole = layered(plate, [Layer(bond=1.0)] * (count - 1))
        for name in ("bending_warp", "bending_weft", "bending_bias"):
            assert getattr(whole, name) == pytest.approx(count**3 * k * t * t / 12, rel=1e-12)


def test_tensions_of_curves_add_up() -> None:
    locking = replace(FUSING, strain_limit=0.05)
    curved = replace(SHELL, stretch_curve_weft=((0.02, 30.0), (0.1, 400.0)))
    both = layered(curved, [Layer(fabric=locking)])
    assert both.strain_limit == 0.0
    for strain in (0.004, 0.021, 0.033, 0.05, 0.08, 0.12):
        for table, one, two in zip(
            curve_tables(both), curve_tables(curved), curve_tables(locking), strict=True
        ):
            wanted = tension_at(one, strain) + tension_at(two, strain)
            assert tension_at(table, strain) == pytest.approx(wanted, rel=0.01)


def cloth_of(*layers: Layer, **parts: Any) -> Cloth:
    return assemble_cloth([(meshed(layers=layers, **parts), SHELL)], [np.empty(0, np.int32)])


def test_weight_is_that_of_every_layer_where_it_lies() -> None:
    plain = cloth_of()
    hem = Layer(run="left.0", width=0.035)
    facing = Layer(fabric=FUSING, run="left.3", width=0.1)
    cloth = cloth_of(hem, facing)
    more = 0.4 * 0.035 * SHELL.areal_density + 0.3 * 0.1 * FUSING.areal_density
    assert cloth.mass.sum() - plain.mass.sum() == pytest.approx(more, rel=1e-9)
    thickness = cloth.per_face("thickness")
    # Plain, in the facing, in the hem, and where they meet.
    assert np.unique(thickness) == pytest.approx([3e-4, 5e-4, 6e-4, 8e-4])
    both = np.isclose(thickness, 8e-4)
    assert cloth.rest_area[both].sum() == pytest.approx(0.1 * 0.035, rel=1e-9)
    assert plain.fabrics == (SHELL,) and not plain.fabric.any()


def test_remeshing_keeps_what_lies_under_each_layer() -> None:
    """Twelve passes over waves that come and go; the border is a line at a height of 35 mm."""
    cloth = cloth_of(Layer(run="left.0", width=0.035))
    cloth = replace(cloth, stitches=cloth.stitches[:0], seam=cloth.seam[:0])
    area = np.bincount(cloth.fabric, cloth.rest_area)
    generator = np.random.default_rng(5)
    changes = 0
    for _ in range(12):
        height = 0.01 * np.sin(cloth.uv @ generator.uniform(-60.0, 60.0, 2))
        apart = np.zeros(len(cloth.uv))
        apart[cloth.faces[cloth.panel == 1]] = 0.5
        positions = np.column_stack([cloth.uv[:, 0] + apart, cloth.uv[:, 1], height])
        cloth = replace(cloth, positions=positions)
        stepper = cloth_stepper(cloth, None, replace(OPTIONS, self_contact=False), StageClock())
        found = remeshed(cloth, stepper, replace(FINE, size_min=0.02, size_max=0.1))
        if found is not None:
            cloth, changes = found.cloth, changes + found.splits + found.collapses
    assert changes > 300
    assert np.bincount(cloth.fabric, cloth.rest_area) == pytest.approx(area, rel=1e-12)
    hem = cloth.uv[cloth.faces[cloth.fabric == 1], 1]
    assert hem.max() == pytest.approx(0.035, abs=1e-9)


def _turning(gamma: float, s: Float, y: Float) -> Float:
    return np.array([y[1], -gamma * (1.0 - s) * np.cos(y[0])])


def elastica(gamma: float) -> tuple[float, float]:
    """Drop and reach of the tip of a strip of length 1 clamped level, gamma = weight per area L^3/D."""
    s = np.linspace(0.0, 1.0, 101)
    y = np.zeros((2, len(s)))
    # From light to heavy, so that the solution is the one that hangs.
    for load in np.geomspace(1.0, gamma, 20):
        turning = partial(_turning, load)
        found = solve_bvp(turning, lambda a, b: np.array([a[0], b[1]]), s, y, tol=1e-8, max_nodes=20_000)
        s, y = found.x, found.y
    angle = found.sol(np.linspace(0.0, 1.0, 2001))[0]
    return float(np.trapezoid(np.sin(angle), dx=1 / 2000)), float(np.trapezoid(np.cos(angle), dx=1 / 2000))


@pytest.mark.parametrize("bond", [0.0, 1.0])
def test_a_strip_with_interlining_sags_as_the_sum_of_both(bond: float) -> None:
    """A strip of 6 x 1.5 cm, clamped level along 7.5 mm more: through pattern, mesh, cloth and forces."""
    length, behind = 0.06, 0.0075
    corners = ((-behind, 0.0), (length, 0.0), (length, 0.015), (-behind, 0.015))
    panel = Panel(name="strip", vertices=corners, edges=tuple(Edge(i, (i + 1) % 4) for i in range(4)))
    edges = SewingEdges(0.0025, 0.0025)
    layer = Layer(fabric=FUSING, bond=bond)
    clamp = ((-1.0, -1.0), (0.0, -1.0), (0.0, 1.0), (-1.0, 1.0))
    # A second layer that ends where the clamp does gives the mesh a line there.
    parts = Parts(layers=(layer, Layer(polygon=clamp)))
    mesh = mesh_with_parts(Pattern(name="strip", panels=(panel,), stitches=()), parts, edges, 24.0)
    held = np.flatnonzero(mesh.uv[:, 0] < 1e-9).astype(np.int32)
    cloth = assemble_cloth([(mesh, SHELL)], [held])
    level = np.column_stack([mesh.uv[:, 0], np.zeros(len(mesh.uv)), -mesh.uv[:, 1]])
    cloth = replace(cloth, positions=level)
    stepper = cloth_stepper(
        cloth, None, replace(free_options(gravity=9.81), self_contact=False), StageClock()
    )
    stepper.step(SETTLED)
    tip = np.isclose(mesh.uv[:, 0], length)
    drop, reach = -stepper.x[tip, 1].mean() / length, stepper.x[tip, 0].mean() / length
    apart = 0.5 * (SHELL.thickness + FUSING.thickness)
    # The weft of a panel lies along x.
    rigidity = 4e-6 + bond * 2500.0 * 800.0 / 3300.0 * apart**2
    wanted = elastica((SHELL.areal_density + FUSING.areal_density) * 9.81 * length**3 / rigidity)
    assert drop / reach == pytest.approx(wanted[0] / wanted[1], rel=0.02)


def test_keys_of_a_scene_file_and_their_fabrics(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        '[[garment]]\nsource = "tshirt"\n[[garment.layer]]\nfabric = "canvas"\nbond = 0.3\n'
        'panels = ["front"]\n'
        '[[garment.layer]]\nrun = "hem"\nwidth = 0.03\n'
    )
    scene = load_scene(path)
    assert scene.garments[0].layers == (
        Layer(fabric="canvas", bond=0.3, panels=("front",)), Layer(run="hem", width=0.03),
    )  # fmt: skip
    (garment,) = resolve(scene).garments
    assert [layer.fabric for layer in garment.parts.layers] == [fabric("canvas"), None]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"bond": 2.0}, "bond must lie between 0 and 1"),
        ({"fabric": 3}, "fabric is a name"),
        ({"run": "left.0"}, "run and width belong together"),
        ({"panels": ("lfet",)}, "left"),
        ({"polygon": ((5.0, 5.0), (6.0, 5.0), (6.0, 6.0))}, "layer: no part of the garment lies in it"),
    ],
)
def test_mistakes_are_told_in_a_line(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        meshed(layers=(Layer(**given),))
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_an_unknown_fabric_is_told() -> None:
    scene = Scene(garments=[Garment("tshirt", layers=[Layer(fabric="canvass")])])
    with pytest.raises(InputError, match="canvas"):
        resolve(scene)
