"""Fields, elastic and gas of garments: found on patterns, cut into meshes, refused with a reason."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from toile.dressing.garment.fabrics import fabric
from toile.dressing.garment.fields.field import Elastic, Field, Filling, Hold, Painted, Parts, Textured
from toile.dressing.garment.fields.mesh_parts import mesh_with_parts, parts_on_mesh
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.pattern import Arc, Edge, Panel, Pattern, Stitch
from toile.dressing.pattern.sewing_edges import SewingEdges
from toile.dressing.wear.assemble_cloth import assemble_cloth
from toile.engine.cloth.fields.keyed import Keyed
from toile.geometry.errors import InputError

EDGES = SewingEdges(0.03, 0.03)
CORNERS = ((0.0, 0.0), (0.4, 0.0), (0.4, 0.3), (0.0, 0.3))


def pattern() -> Pattern:
    """Two rectangles, the upper edge of one an arc, sewn along one side; their waists are above."""

    def panel(name: str, x: float, curve: Arc | None) -> Panel:
        edges = tuple(
            Edge(i, (i + 1) % 4, curve if i == 2 else None, role="waist" if i == 2 else None)
            for i in range(4)
        )
        return Panel(name=name, vertices=CORNERS, edges=edges, translation=(x, 0.0, 0.0))

    return Pattern(
        name="two", panels=(panel("left", 0.0, None), panel("right", 0.5, Arc(0.5, False, True))),
        stitches=(Stitch("left", 1, "right", 3),),
    )  # fmt: skip


def meshed(*fields: Field, **parts: Any) -> GarmentMesh:
    return mesh_with_parts(pattern(), Parts(fields=fields, **parts), EDGES, 24.0)


def areas(mesh: GarmentMesh) -> dict[str, float]:
    """Area that has a value of each quantity [m^2]."""
    assert mesh.fields is not None
    sides = mesh.rest_corners[:, 1:] - mesh.rest_corners[:, :1]
    area = 0.5 * np.linalg.det(sides)
    assert area.min() > 0.0
    return {name: float(area[mesh.fields.where(name)].sum()) for name in mesh.fields.names()}


def test_a_band_beside_an_edge_has_its_width_exactly() -> None:
    mesh = meshed(Field(run="left.2", width=0.035, values={"rest_weft": 0.8}))
    assert areas(mesh) == pytest.approx({"rest_weft": 0.4 * 0.035}, rel=1e-9)
    plain = mesh_pattern(pattern(), edge_length=0.03)
    assert mesh.minimum_angle > 10.0
    assert len(mesh.faces) < 1.3 * len(plain.faces)


def test_the_sewn_edge_of_the_other_panel_is_cut_alike() -> None:
    mesh = meshed(Field(run="left.2", width=0.035, values={"rest_weft": 0.8}))
    a, b = mesh.uv[mesh.stitches[:, 0]], mesh.uv[mesh.stitches[:, 1]]
    assert a[:, 1] == pytest.approx(b[:, 1], abs=1e-12)
    assert np.abs(a[:, 1] - 0.265).min() < 1e-12
    panel = np.zeros(len(mesh.uv), int)
    panel[mesh.faces] = mesh.panel[:, None]
    assert set(panel[mesh.stitches[:, 0]]) == {0} and set(panel[mesh.stitches[:, 1]]) == {1}


def test_a_band_along_an_arc_follows_it() -> None:
    """Its border consists of chords between points at the width."""
    mesh = meshed(Field(run="waist", panels=("right",), width=0.05, values={"shear": 1.0}))
    assert mesh.fields is not None
    inside = np.unique(mesh.faces[mesh.fields.where("shear")])
    outside = np.unique(mesh.faces[~mesh.fields.where("shear") & (mesh.panel == 1)])
    line = mesh.uv[np.intersect1d(inside, outside)]
    ends = (line[:, 0] < 1e-9) | (line[:, 0] > 0.4 - 1e-9)
    assert ends.sum() == 2
    # There it goes around the ends of the arc.
    assert line[ends, 1] == pytest.approx(0.25, abs=1e-9)
    line = line[~ends]
    centre = np.array([0.2, 0.3 - np.sqrt(0.25 - 0.04)])
    assert np.linalg.norm(line - centre, axis=1) == pytest.approx(0.45, abs=1e-4)


def test_polygons_and_panels_overlap_and_the_last_counts() -> None:
    half = Field(polygon=((-1.0, -1.0), (0.2, -1.0), (0.2, 1.0), (-1.0, 1.0)), values={"shear": 2.0})
    mesh = meshed(Field(panels=("left",), values={"shear": 1.0, "damping": 0.1}), half)
    assert mesh.fields is not None
    middle = mesh.uv[mesh.faces].mean(axis=1)
    found = mesh.fields.over("shear", np.zeros(len(middle)))
    expected = np.where(middle[:, 0] < 0.2, 2.0, np.where(mesh.panel == 0, 1.0, 0.0))
    assert found == pytest.approx(expected)
    assert mesh.fields.over("damping", np.zeros(len(middle))) == pytest.approx(0.1 * (mesh.panel == 0))
    corner = mesh.uv[mesh.faces][:, :, 0]
    assert not ((corner.min(axis=1) < 0.2 - 1e-9) & (corner.max(axis=1) > 0.2 + 1e-9)).any()


def lengths(mesh: GarmentMesh) -> list[float]:
    """Length of every run of elastic [m], as the cloth has it."""
    cloth = assemble_cloth([(mesh, fabric("cotton-poplin"))], [np.empty(0, np.int32)])
    ends = [run.lines[:, 1] - run.lines[:, 0] for run in cloth.elastic]
    return [float(np.linalg.norm(way, axis=1).sum()) for way in ends]


FIRM = {"rest": 0.8, "stiffness": 5.0}


def test_runs_of_elastic_by_role_and_by_parts_of_edges() -> None:
    by_role = meshed(elastic=(Elastic(run="waist", **FIRM),))
    assert [run.panel for run, _ in by_role.elastic] == [0, 1]
    assert lengths(by_role) == pytest.approx([0.4, 2 * 0.5 * np.arcsin(0.4)], rel=1e-2)
    parts = meshed(elastic=(Elastic(run="left.0[0.25:0.5] + right.0", **FIRM),))
    assert lengths(parts) == pytest.approx([0.1, 0.4], abs=1e-12)


def test_runs_of_meshes_are_labels_of_their_borders() -> None:
    plain = mesh_pattern(pattern(), edge_length=0.05)
    waist = plain.edges["waist"]
    bent = plain.positions + [0.0, 0.0, 0.1] * np.sin(9.0 * plain.positions[:, :1])
    mesh = replace(plain, flat=False, borders=(), edges={}, held={"top": waist}, positions=bent)
    found = parts_on_mesh(mesh, Parts(elastic=(Elastic(run="top", **FIRM),)), 24.0)
    # Moved before it is assembled, as layers are.
    moved = replace(found, positions=found.positions + 1.0)
    straight = np.linspace(0.0, 0.4, 2000)
    height = 0.1 * np.sin(9.0 * straight)
    curve = float(np.hypot(np.diff(straight), np.diff(height)).sum())
    assert lengths(moved)[0] == pytest.approx(curve, rel=1e-2)
    with pytest.raises(InputError, match=r"unknown edge 'topp'; did you mean 'top'"):
        parts_on_mesh(mesh, Parts(elastic=(Elastic(run="topp", **FIRM),)), 24.0)


def test_an_image_covers_its_panel() -> None:
    image = np.tile(np.linspace(0.0, 1.0, 40), (3, 1))
    mesh = meshed(Field(panels=("left",), values={"shear": Textured(image, low=10.0, high=50.0)}))
    assert mesh.fields is not None
    rest = np.pad(mesh.uv, ((0, 0), (0, 1)))[mesh.faces]
    found = mesh.fields.on(mesh.fields.region, rest).over("shear", np.zeros(len(mesh.faces)))
    expected = 10.0 + 40.0 * mesh.uv[mesh.faces].mean(axis=1)[:, 0] / 0.4
    assert found[mesh.panel == 0] == pytest.approx(expected[mesh.panel == 0], abs=1.0)
    assert not found[mesh.panel == 1].any()


def test_a_pattern_without_parts_is_meshed_as_ever() -> None:
    plain, without = mesh_pattern(pattern(), edge_length=0.03), meshed()
    assert np.array_equal(plain.positions, without.positions) and np.array_equal(plain.faces, without.faces)
    assert without.fields is None and without.elastic == () == without.gas


def test_holds_last_for_their_frames() -> None:
    ((hold, _),) = meshed(holds=(Hold(run="left.2", frames=(0, 10)),)).holds
    shares = [hold.share.at(frame / 24.0) for frame in (0, 5, 9, 10, 30)]
    assert shares == pytest.approx([1.0, 1.0, 1.0, 0.0, 0.0])
    late = Hold(run="left.2", frames=(4, 5)).shares(24.0)
    assert [late.at(frame / 24.0) for frame in (2, 3, 4, 5)] == pytest.approx([0.0, 0.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: meshed(Field(panels=("lefd",), values={"shear": 1.0})), "panel 'lefd'.*did you mean 'left'"),
        (lambda: meshed(Field(run="wasit", width=0.1, values={"shear": 1.0})), "did you mean 'waist'"),
        (lambda: meshed(Field(run="left.9", width=0.1, values={"shear": 1.0})), "no edge 9, only 0..3"),
        (lambda: meshed(elastic=(Elastic(run="arm", rest=0.8, stiffness=1.0),)), "unknown edge 'arm'"),
        (lambda: meshed(gas=Filling(pressure=10.0)), "edges of the sewn garment are open"),
        (lambda: meshed(Field(values={"shear": Painted("stiff")})), "attribute 'stiff'"),
        (lambda: meshed(Field(values={"pull": 10.0})), "use a hold instead"),
        (
            lambda: meshed(Field(polygon=((9, 9), (10, 9), (9, 10)), values={"shear": 1.0})),
            "no part of the garment lies in it",
        ),
        (lambda: Field(values={"sheer": 1.0}), "did you mean 'shear'"),
        (lambda: Field(values={}), "sets nothing"),
        (lambda: Field(values={"rest_warp": 0.0}), "rest_warp must be between 0.1 and 5"),
        (lambda: Field(values={"areal_density": 0.0}), "areal_density must be at least"),
        (lambda: Field(values={"thickness": Keyed((0.0, 1.0), (1.0, 2.0))}), "cannot change over a film"),
        (lambda: Field(values={"pressure": Keyed((1.0, 0.0), (1.0, 2.0))}), "times of keys must rise"),
        (lambda: Field(run="waist", values={"shear": 1.0}), "run and width belong together"),
        (lambda: Elastic(run="waist", rest=0.8, stiffness=-1.0), "stiffness must be between"),
        (lambda: Filling(), "one of them"),
        (lambda: Hold(run="waist"), "frames"),
        (lambda: Hold(run="waist", frames=(5, 5)), "first that is free"),
    ],
)
def test_what_cannot_be_is_refused_with_a_reason(make: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()


def test_meshes_take_painted_fields_and_pull() -> None:
    mesh = replace(mesh_pattern(pattern(), edge_length=0.05), flat=False)
    height = mesh.positions[:, 1] / 0.3
    mesh = replace(mesh, attributes={"tall": height})
    soft = Field(values={"shear": Painted("tall", 10.0, 20.0), "pull": Painted("tall", 0.0, 100.0)})
    found = parts_on_mesh(mesh, Parts(fields=(soft,)), 24.0)
    assert found.pull == pytest.approx(100.0 * height)
    assert found.fields is not None
    on = found.fields.on(found.fields.region, mesh.positions[mesh.faces])
    expected = 10.0 + 10.0 * height[mesh.faces].mean(axis=1)
    assert on.over("shear", np.zeros(len(mesh.faces))) == pytest.approx(expected, abs=1e-9)
    with pytest.raises(InputError, match="need a pattern"):
        band = Field(run="waist", width=0.1, values={"shear": 1.0})
        parts_on_mesh(mesh, Parts(fields=(band,)), 24.0)
