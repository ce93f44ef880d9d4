"""Fields stay what they are on every mesh: borders and areas of regions, painted and keyed values."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.adapt.test_remeshing import FINE, OPTIONS, POPLIN, cloth_at
from tests.engine.forces.laws.test_stretch_laws import CURVED
from tests.engine.forces.moving_step import MovingStep
from tests.engine.step.test_only_what_is_asked import SLACK, options, sheet
from toile.dressing.garment.fields.cut_mesh import cut_along
from toile.engine.adapt.remeshing import remeshed
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.edge_runs import EdgeRun
from toile.engine.cloth.fields.fields import Fields, Value
from toile.engine.cloth.fields.keyed import Keyed
from toile.engine.cloth.fields.paintings import ImagePainting, VertexPainting
from toile.engine.forces.added.edge_elastic import EdgeElastic
from toile.engine.forces.bend import Bending
from toile.engine.forces.contact_pairs import node_thickness, pair_friction
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.step_request import StepRequest
from toile.engine.step.cloth_forces import cloth_forces, cloth_stepper
from toile.geometry.arrays import Float
from toile.geometry.stage_clock import StageClock
from toile.studies.scenes.flat_meshes import mesh

SLOPE = np.array([3.0, 2.0]) / np.sqrt(13.0)
MIDDLE = 0.75 / np.sqrt(13.0)
"""The line goes through vertices of the border, (0.25, 0) and (0.05, 0.3)."""
PASSES = 50


def beyond(points: Float) -> Float:
    """Distance from a slanting line, negative on the left of it [m]."""
    return np.asarray(points @ SLOPE - MIDDLE)


@pytest.fixture(scope="module")
def half_elastic() -> Cloth:
    """A panel, one half of which is narrower at rest, with elastic along a part of its lower edge."""
    points, faces = mesh("random", 0.4, 0.3, 0.05)
    border = np.asarray((np.abs(points - [0.2, 0.15]) > np.array([0.2, 0.15]) - 1e-9).any(axis=1))
    points, faces = cut_along(points, faces, border, beyond)
    cloth = cloth_at(points, faces, np.pad(points, ((0, 0), (0, 1))))
    right = (beyond(points[faces].mean(axis=1)) > 0.0).astype(np.int32)
    line = np.array([[(0.1, 0.0, 0.0), (0.2, 0.0, 0.0)], [(0.2, 0.0, 0.0), (0.3, 0.0, 0.0)]])
    return replace(
        cloth,
        fields=Fields(region=right, values=({}, {"rest_warp": 0.7, "areal_density": 0.3, "shear": 10.0})),
        elastic=(EdgeRun(garment=0, panel=0, lines=line, rest=0.9, stiffness=5.0),),
    )


def test_a_sharp_border_survives_fifty_passes_where_it_is(half_elastic: Cloth) -> None:
    cloth, fields = half_elastic, half_elastic.fields
    assert fields is not None
    area = np.bincount(fields.region, cloth.rest_area)
    mass = cloth.mass.sum()
    generator = np.random.default_rng(5)
    splits = collapses = 0
    for _ in range(PASSES):
        way, phase = generator.uniform(-60.0, 60.0, 2), generator.uniform(0.0, 6.0)
        height = 0.01 * np.sin(cloth.uv @ way + phase)
        cloth = replace(cloth, positions=np.column_stack([cloth.uv, height]))
        stepper = cloth_stepper(cloth, None, replace(OPTIONS, self_contact=False), StageClock())
        found = remeshed(cloth, stepper, replace(FINE, size_min=0.02, size_max=0.1))
        if found is not None:
            cloth, splits, collapses = found.cloth, splits + found.splits, collapses + found.collapses
    assert splits > 1000 and collapses > 1000
    after = cloth.fields
    assert after is not None
    assert np.bincount(after.region, cloth.rest_area) == pytest.approx(area, rel=1e-12)
    assert cloth.mass.sum() == pytest.approx(mass, rel=1e-12)
    # No face lies on both sides, and vertices of the border are on the line.
    corner = beyond(cloth.uv)[cloth.faces]
    assert corner[after.region == 0].max() < 1e-9 and corner[after.region == 1].min() > -1e-9
    elastic = EdgeElastic.for_cloth(cloth)
    assert elastic is not None
    assert elastic.edges.lengths.sum() == pytest.approx(0.2, rel=1e-12)


def test_what_a_field_sets_takes_the_place_of_what_the_fabric_has(half_elastic: Cloth) -> None:
    cloth = half_elastic
    assert cloth.fields is not None
    right = cloth.fields.region == 1
    assert cloth.per_face("shear")[right] == pytest.approx(10.0)
    assert cloth.per_face("shear")[~right] == pytest.approx(POPLIN.shear)
    expected = np.where(right, 0.3, POPLIN.areal_density) * cloth.rest_area
    assert cloth.mass.sum() == pytest.approx(expected.sum())
    forces = cloth_forces(cloth, options())
    membrane = next(force for force in forces if isinstance(force, Membrane))
    assert membrane.shape[:, 0] == pytest.approx(np.where(right, 0.7, 1.0) * cloth.rest_area)
    stiff = replace(cloth, fields=replace(cloth.fields, values=({}, {"bending_warp": 1.0})))
    bending = next(force for force in cloth_forces(stiff, options()) if isinstance(force, Bending))
    assert bending.rigidity[right, 0, 0] == pytest.approx(cloth.rest_area[right])


def test_thickness_and_friction_of_regions() -> None:
    cloth = sheet(replace(SLACK, friction_body=0.35, friction_self=0.3))
    right = (cloth.uv[cloth.faces].mean(axis=1)[:, 0] > 0.5).astype(np.int32)
    values: tuple[dict[str, Value], ...] = (
        {},
        {"thickness": 2e-3, "friction_body": 0.8, "friction_self": 0.6},
    )
    cloth = replace(cloth, fields=Fields(region=right, values=values))
    inside = np.setdiff1d(cloth.faces[right == 1], cloth.faces[right == 0])
    outside = np.setdiff1d(cloth.faces[right == 0], cloth.faces[right == 1])
    assert node_thickness(cloth)[inside] == pytest.approx(2e-3)
    assert node_thickness(cloth)[outside] == pytest.approx(SLACK.thickness)
    found = pair_friction(cloth, 1, {frozenset((SLACK.name, "body")): 0.2})
    body, one, other = found.material[-1], found.material[outside[0]], found.material[inside[0]]
    assert found.table[one, body] == pytest.approx(0.2)  # named for the fabric
    assert found.table[other, body] == pytest.approx(0.8)
    assert found.table[one, one] == pytest.approx(0.3) and found.table[other, other] == pytest.approx(0.6)
    assert found.table[one, other] == pytest.approx(np.sqrt(0.3 * 0.6))


def test_painted_values_do_not_depend_on_the_mesh() -> None:
    """Linear ones come out exactly on other triangles; and those of an image, bilinear, at pixel middles."""
    points, faces = mesh("random", 1.0, 1.0, 0.2)
    rest = np.pad(points, ((0, 0), (0, 1)))
    painting = VertexPainting(points=rest, faces=faces, values=3.0 + points @ [1.0, -2.0])
    other, other_faces = mesh("right", 1.0, 1.0, 0.07)
    fields = Fields(region=np.zeros(len(faces), np.int32), values=({"shear": painting},))
    carried = fields.on(np.zeros(len(other_faces), np.int32), np.pad(other, ((0, 0), (0, 1)))[other_faces])
    expected = 3.0 + other[other_faces].mean(axis=1) @ [1.0, -2.0]
    assert carried.over("shear", np.zeros(len(other_faces))) == pytest.approx(expected, abs=1e-12)
    image = ImagePainting(values=np.array([[1.0, 2.0], [3.0, 4.0]]), low=(0.0, 0.0), high=(2.0, 2.0))
    at = np.array([(0.5, 1.5, 0.0), (1.5, 0.5, 0.0), (1.0, 1.0, 0.0), (-9.0, 9.0, 0.0)])
    assert image.at(at) == pytest.approx([1.0, 4.0, 2.5, 1.0])


def test_keys_count_from_the_frame_after_the_lead_in() -> None:
    keyed = Keyed((1.0, 3.0), (0.0, 10.0))
    assert [keyed.at(t) for t in (0.0, 1.5, 9.0)] == [0.0, 2.5, 10.0]
    fields = Fields(region=np.zeros(3, np.int32), values=({"pressure": keyed},)).later(2.0)
    assert fields.over("pressure", np.zeros(3), 4.0) == pytest.approx(5.0)
    assert fields.is_keyed(["pressure"]) and not fields.is_keyed(["shear"])


def test_fields_of_garments_together_keep_their_values() -> None:
    one = Fields(region=np.array([0, 1], np.int32), values=({}, {"shear": 5.0}))
    both = Fields.together([one, None, one], [2, 3, 2])
    assert both is not None
    assert both.over("shear", np.ones(7)).tolist() == [1, 5, 1, 1, 1, 1, 5]
    assert Fields.together([None, None], [2, 3]) is None


def test_a_keyed_membrane_is_the_membrane_of_its_time() -> None:
    """With stretch curves and Poisson's ratio, and without."""
    for fabric in (replace(SLACK, compression=0.1), CURVED):
        keyed: dict[str, Value] = {
            "rest_warp": Keyed((0.0, 1.0), (1.0, 0.9)),
            "stretch_weft": Keyed((0.0, 1.0), (50.0, 150.0)),
        }
        there: dict[str, Value] = {"rest_warp": 0.95, "stretch_weft": 100.0}
        cloth = sheet(fabric)
        region = np.zeros(len(cloth.faces), np.int32)
        x = 1.03 * cloth.positions
        found = []
        for values in (keyed, there):
            own = replace(cloth, fields=Fields(region=region, values=(values,)))
            (membrane,) = (f for f in cloth_forces(own, options()) if isinstance(f, Membrane))
            membrane.begin(MovingStep(StepRequest(h=0.1, at_rest=False, seconds=0.5), x), x)
            gradient = np.zeros_like(x)
            membrane.add_gradient(x, gradient)
            found.append((membrane.energy(x), gradient))
        assert found[0][0] == pytest.approx(found[1][0], rel=1e-12) and found[0][0] > 0.0
        assert found[0][1] == pytest.approx(found[1][1], rel=1e-10, abs=1e-12)
