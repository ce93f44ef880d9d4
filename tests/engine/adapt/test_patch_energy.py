"""Energies of single triangles against those of a whole membrane."""

import numpy as np

from toile.engine.adapt.patch_energy import patch_energies
from toile.engine.forces.membrane import Membrane


def test_triangles_have_the_energy_of_a_membrane() -> None:
    """Stretched and compressed ones, in any order, one of them without rest area."""
    random = np.random.default_rng(3)
    count, nodes = 50, 20
    triangles = np.array([random.choice(nodes, 3, replace=False) for _ in range(count)], np.int32)
    corners = random.normal(size=(count, 3, 2))
    corners[7, 2] = 2.0 * corners[7, 1] - corners[7, 0]
    stiffness = random.uniform(0.1, 3000.0, (4, 4))
    stiffness[:, 3] = random.uniform(0.0, 1.0, 4)
    like = random.integers(0, 4, count).astype(np.int32)
    x = random.normal(size=(nodes, 3))
    membrane = Membrane(triangles, corners, *stiffness[like].T)
    membrane.energy(x)
    found = patch_energies(x, triangles, corners, stiffness, like)
    np.testing.assert_allclose(found, membrane.element_energy, rtol=1e-12)
    assert found.min() >= 0.0 and found[7] < 1e-20 + found.max()
