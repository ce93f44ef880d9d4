"""Strain along the threads, as the engine's membrane measures it."""

from types import SimpleNamespace
from typing import cast

import numpy as np

from toile.dressing.wear.strain import warp_weft_strain
from toile.engine.cloth.cloth import Cloth
from toile.engine.forces.membrane import Membrane
from toile.geometry.arrays import Float

REST = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[0.2, 0.1], [0.9, 0.3], [0.4, 1.2]]])
PLACES = np.array([[0.0, 0.0, 0.0], [1.2, 0.0, 0.0], [0.0, 0.0, 0.9], [0.3, 0.7, 0.2]])
FACES = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)


def cloth(rest: Float) -> Cloth:
    """A stand-in with what the strain is made of."""
    return cast("Cloth", SimpleNamespace(natural_corners=rest, positions=PLACES, face_nodes=FACES))


def test_a_stretched_face_says_by_how_much() -> None:
    assert np.allclose(warp_weft_strain(cloth(REST))[0], [0.2, -0.1])


def test_it_is_the_strain_of_the_membrane() -> None:
    some = np.ones(2)
    membrane = Membrane(FACES, REST, some, some, some)
    assert np.allclose(warp_weft_strain(cloth(REST)), membrane.warp_weft_strain(PLACES), rtol=0, atol=1e-14)


def test_a_face_without_rest_area_has_none() -> None:
    flat = REST.copy()
    flat[1, 2] = flat[1, 1]
    assert np.array_equal(warp_weft_strain(cloth(flat))[1], [0.0, 0.0])
