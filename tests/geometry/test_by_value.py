"""Public values that hold arrays are compared by value, and can be keys."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import trimesh

import toile
from tests.dressing.run.test_dress import square


def dressed() -> toile.DressedGarment:
    mesh = square()
    return toile.DressedGarment(
        name="a", fabric=toile.fabric("canvas"), positions=mesh.positions, faces=mesh.faces, uv=mesh.uv,
        uv_faces=mesh.faces, panel=mesh.panel, panel_names=("front",), strain=np.array([[np.nan, 0.0]] * 2),
    )  # fmt: skip


def motion() -> toile.VertexMotion:
    return toile.VertexMotion(frames=np.zeros((2, 3, 3)), fps=24.0)


def scene(**fields: object) -> toile.Scene:
    garment = toile.Garment(square(), pins=[1], panel_fabrics={"front": "canvas"})
    return toile.Scene(garments=[garment], fabrics={"mine": toile.fabric("canvas")}, **fields)  # type: ignore[arg-type]


def ball() -> toile.Avatar:
    shape = trimesh.creation.icosphere(subdivisions=1)
    return toile.Avatar(name="ball", vertices=np.array(shape.vertices), faces=np.array(shape.faces, np.int32))


@pytest.mark.parametrize(
    ("make", "change"),
    [
        (dressed, lambda value: replace(value, positions=value.positions + 1e-9)),
        (square, lambda value: replace(value, uv=value.uv + 1.0)),
        (motion, lambda value: replace(value, fps=25.0)),
        (ball, lambda value: replace(value, vertices=2.0 * value.vertices)),
        (scene, lambda value: replace(value, friction_between={("canvas", "body"): 0.5})),
        (scene, lambda value: replace(value, garments=[toile.Garment("tshirt")])),
    ],
)
def test_equal_values_are_equal_and_have_one_hash(
    make: Callable[[], Any], change: Callable[[Any], Any]
) -> None:
    value = make()
    copy, other = deepcopy(value), change(value)
    assert value == copy and hash(value) == hash(copy)
    assert value != other and value != "something else"
    assert {value: 1}[copy] == 1
