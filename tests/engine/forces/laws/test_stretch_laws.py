"""Stretch curves and Poisson's ratio: derivatives, smoothness, curves; `validate_stretch` pulls strips."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.step.test_only_what_is_asked import SLACK
from toile.engine.adapt.patch_energy import patch_energies
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.stretch_curve import LOCKED, limited, tension_at, through
from toile.engine.forces.laws.curved_membrane import CurvedMembrane
from toile.engine.forces.laws.stretch_laws import stretch_laws
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.membrane_damping import MembraneDamping
from toile.engine.solve.assembly import node_pairs
from toile.geometry.arrays import Float
from toile.studies.scenes.flat_meshes import mesh

WARP = ((0.01, 8.0), (0.03, 40.0), (0.05, 150.0), (0.06, 300.0))
WEFT = ((0.02, 10.0), (0.05, 60.0), (0.08, 250.0))
CURVED = replace(
    SLACK, name="curved", stretch_warp=1000.0, stretch_weft=600.0, shear=40.0, compression=0.1,
    stretch_curve_warp=WARP, stretch_curve_weft=WEFT, poisson=0.6,
)  # fmt: skip
REST = np.array([[[0.1, 0.0], [1.1, 0.3], [0.4, 0.9]]])
FACE = np.array([[0, 1, 2]], np.int32)


def membrane_of(fabric: Fabric, faces: np.ndarray = FACE, rest: Float = REST) -> CurvedMembrane:
    ones = np.ones(len(faces))
    stretch, compression = (fabric.stretch_warp * ones, fabric.stretch_weft * ones), fabric.compression * ones
    laws = stretch_laws((fabric,), np.zeros(len(faces), np.int32), *stretch, compression)
    assert laws is not None
    return CurvedMembrane(faces, rest, stretch, fabric.shear * ones, compression, laws)


def stretched(warp: float, weft: float) -> Float:
    """The face stretched by so much along its threads, sheared a little and turned."""
    moved = REST[0] @ np.array([[1.0 + warp, 0.02, 0.0], [0.01, 1.0 + weft, 0.1]])
    return np.ascontiguousarray(moved)


STATES = [(0.045, 0.03), (0.07, 0.2), (0.02, -0.1), (-0.1, 0.03), (-0.2, -0.1), (0.04, -0.01), (-0.005, 0.04)]


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize(
    "fabric", [CURVED, replace(CURVED, poisson=0.0, strain_limit=0.04, stretch_curve_weft=())]
)
def test_derivatives_agree_with_differences(state: tuple[float, float], fabric: Fabric) -> None:
    membrane, x, size = membrane_of(fabric), stretched(*state), 1e-6
    membrane.evaluate(x)
    gradient = membrane.element_gradient[0].copy()
    energy = float(membrane.element_energy[0])
    assert membrane.energy(x) == energy
    blocks = np.zeros((3, 3, 3, 3))
    for pair, (a, b) in enumerate(node_pairs(3)):
        blocks[a, :, b, :] = membrane.element_hessian[0, pair]
        blocks[b, :, a, :] = membrane.element_hessian[0, pair].T
    hessian = blocks.reshape(9, 9)
    differences, second = np.empty(9), np.empty((9, 9))
    for entry, step in enumerate(size * np.eye(9).reshape(9, 3, 3)):
        ahead, behind = membrane.energy(x + step), membrane.energy(x - step)
        differences[entry] = (ahead - behind) / (2.0 * size)
        membrane.evaluate_gradient(x + step)
        ahead_gradient = membrane.element_gradient[0].copy()
        membrane.evaluate_gradient(x - step)
        second[entry] = (ahead_gradient - membrane.element_gradient[0]).ravel() / (2.0 * size)
    scale = np.abs(gradient).max() + 1.0
    np.testing.assert_allclose(differences, gradient.ravel(), atol=1e-7 * scale)
    assert np.linalg.eigvalsh(hessian).min() > -1e-9 * np.abs(hessian).max()
    if min(state) > 0.0:
        # Both threads are taut: only shear could have a negative part, and it has hardly any.
        np.testing.assert_allclose(hessian, second, atol=3e-3 * np.abs(second).max())


def test_tension_is_continuous_everywhere() -> None:
    """Across the borders of taut, gathered and slack cloth, and of the pieces of curves."""
    membrane, size = membrane_of(replace(CURVED, shear=0.0)), 1e-9
    for way in np.random.default_rng(5).normal(size=(40, 2)):
        for share in np.linspace(-0.08, 0.08, 23):
            jump = []
            for s in (share - size, share + size):
                membrane.evaluate_gradient(stretched(*(s * way)))
                jump.append(membrane.element_gradient[0].copy())
            assert np.abs(jump[1] - jump[0]).max() < 1e-3


def test_curves_pass_through_their_points_and_never_fall() -> None:
    for points in (WARP, WEFT, ((0.1, 5.0),), ((0.01, 10.0), (0.02, 10.1), (0.03, 40.0))):
        table = through(points)
        for strain, tension in points:
            assert tension_at(table, strain) == pytest.approx(tension)
        strains = np.linspace(0.0, 0.2, 2001)
        tensions = np.array([tension_at(table, strain) for strain in strains])
        assert (np.diff(tensions) > 0.0).all()
        # C1: slopes of neighbouring short secants differ by no more than the step allows
        slopes = np.diff(tensions) / np.diff(strains)
        assert np.abs(np.diff(slopes)).max() < 0.06 * slopes.max()
        energy = np.concatenate(([0.0], np.cumsum(0.5 * (tensions[1:] + tensions[:-1]) * np.diff(strains))))
        for row in table:
            assert row[1] == pytest.approx(np.interp(row[0], strains, energy), rel=1e-3, abs=1e-6)


def test_a_strain_limit_is_a_curve_that_locks() -> None:
    table = limited(3000.0, 0.04)
    assert tension_at(table, 0.02) == pytest.approx(60.0)
    assert tension_at(table, 0.05) - tension_at(table, 0.04) == pytest.approx(LOCKED * 3000.0 * 0.01)
    slope = (tension_at(table, 0.04) - tension_at(table, 0.04 - 1e-7)) / 1e-7
    assert slope == pytest.approx(LOCKED * 3000.0, rel=1e-4)


def test_without_a_law_it_is_the_membrane() -> None:
    """A law of constant stiffness has the energy and forces of the plain membrane to rounding."""
    points, faces = mesh("random", 1.0, 0.6, 0.2)
    rest, generator = np.ascontiguousarray(points[faces]), np.random.default_rng(1)
    x = np.pad(points, ((0, 0), (0, 1))) + 0.05 * generator.normal(size=(len(points), 3))
    same = replace(CURVED, stretch_curve_warp=(), stretch_curve_weft=(), poisson=1e-12)
    curved, ones = membrane_of(same, faces, rest), np.ones(len(faces))
    plain = Membrane(faces, rest, 1000.0 * ones, 600.0 * ones, 40.0 * ones, 0.1)
    curved.evaluate(x)
    plain.evaluate(x)
    np.testing.assert_allclose(curved.element_energy, plain.element_energy, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(curved.element_gradient, plain.element_gradient, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(curved.element_hessian, plain.element_hessian, rtol=1e-7, atol=1e-7)
    np.testing.assert_array_equal(MembraneDamping(curved, 1.0)._shape, plain.shape)


def test_remeshing_counts_the_energy_of_curves() -> None:
    points, faces = mesh("random", 1.0, 0.6, 0.2)
    fabrics, fabric = (SLACK, CURVED), (np.arange(len(faces)) % 2).astype(np.int32)
    names = ("stretch_warp", "stretch_weft", "shear", "compression")
    stiffness = np.array([[getattr(f, name) for name in names] for f in fabrics])[fabric]
    warp, weft, shear, compression = stiffness.T
    laws = stretch_laws(fabrics, fabric, warp, weft, compression)
    assert laws is not None
    membrane = CurvedMembrane(faces, points[faces], (warp, weft), shear, compression, laws)
    x = np.pad(1.04 * points, ((0, 0), (0, 1)))
    membrane.energy(x)
    order = np.random.default_rng(2).permutation(len(faces)).astype(np.int32)
    found = patch_energies(x, faces[order], points[faces][order], stiffness, order, laws)
    np.testing.assert_allclose(found, membrane.element_energy[order], rtol=1e-12)
