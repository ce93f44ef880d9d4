"""Contact properties of cloth: thickness of every node, friction of every pair of materials."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fields.fields import Fields
from toile.engine.forces.contact import PairFriction
from toile.geometry.arrays import Float, Int

FINEST = 2
"""Decimals to which painted friction is rounded: every value that occurs is a material of its own."""
BODY = "body"
"""Name of the avatar's surface beside those of fabrics."""


class SkinPart(NamedTuple):
    """Vertices of an avatar that are no part of the body: an obstacle beside it.

    Attributes
    ----------
    name
        Name that pairs with friction of their own call it by.
    begin, end
        First vertex, and the one after the last.
    friction
        Coulomb coefficient of all cloth on it; None: that on the body.
    """

    name: str
    begin: int
    end: int
    friction: float | None = None


def node_thickness(cloth: Cloth) -> Float:
    """Thickness of the thickest fabric at every node [m], shape (n,)."""
    thickness = np.zeros(len(cloth.positions))
    np.maximum.at(thickness, cloth.face_nodes.ravel(), np.repeat(cloth.per_face("thickness"), 3))
    return thickness


def pair_friction(
    cloth: Cloth, avatar_vertices: int, named: Mapping[frozenset[str], float],
    parts: Sequence[SkinPart] = (), rows: Int | None = None,
) -> PairFriction:  # fmt: skip
    """Return friction between the fabrics of a cloth and an avatar of so many vertices.

    `named` gives coefficients of pairs of fabrics, or of a fabric and BODY or a part of the avatar, by their
    names. Else a fabric has its own on the body and on itself, and two fabrics have the geometric mean of
    theirs. Where fields have friction, it is theirs. `rows` are the numbers in the whole avatar of its
    vertices, shape (avatar_vertices,), where it is a piece of one.
    """
    found = _pairs_with_body(cloth, avatar_vertices, named)
    if not parts:
        return found
    material, table = found.material.copy(), found.table
    count, body = len(table), len(table) - 1
    wide = np.zeros((count + len(parts), count + len(parts)))
    wide[:count, :count] = table
    nodes = len(cloth.positions)
    rows = np.arange(avatar_vertices, dtype=np.int32) if rows is None else rows
    # The fabric of every material of the cloth: where fields have friction, several are of one.
    fabric = np.zeros(body, np.int32)
    fabric[material[cloth.face_nodes.ravel()]] = np.repeat(cloth.fabric, 3)
    for number, part in enumerate(parts, count):
        material[nodes:][(rows >= part.begin) & (rows < part.end)] = number
        for kind in range(body):
            usual = table[kind, body] if part.friction is None else part.friction
            pair = frozenset((cloth.fabrics[int(fabric[kind])].name, part.name))
            wide[kind, number] = wide[number, kind] = named.get(pair, usual)
    return PairFriction(material, wide)


def _pairs_with_body(
    cloth: Cloth, avatar_vertices: int, named: Mapping[frozenset[str], float]
) -> PairFriction:
    """Return the friction of a cloth and an avatar that is all body."""
    if cloth.fields is not None and cloth.fields.names() & {"friction_body", "friction_self"}:
        return _friction_of_fields(cloth, cloth.fields, avatar_vertices, named)
    count = len(cloth.fabrics)
    material = np.full(len(cloth.positions) + avatar_vertices, count, np.int32)
    # Of a node on the seam of two fabrics the first counts.
    np.minimum.at(material, cloth.face_nodes.ravel(), np.repeat(cloth.fabric, 3))
    table = np.zeros((count + 1, count + 1))
    for i, one in enumerate(cloth.fabrics):
        table[i, count] = table[count, i] = named.get(frozenset((one.name, BODY)), one.friction_body)
        for j, other in enumerate(cloth.fabrics):
            table[i, j] = named.get(frozenset((one.name, other.name)), _mean(one, other))
    return PairFriction(material, table)


def _friction_of_fields(
    cloth: Cloth, fields: Fields, avatar_vertices: int, named: Mapping[frozenset[str], float]
) -> PairFriction:
    """Return the friction of a cloth with fields: a material for every fabric and friction that occur."""
    own = [fields.where(name) for name in ("friction_body", "friction_self")]
    given = [np.round(cloth.per_face(name), FINEST) for name in ("friction_body", "friction_self")]
    rows = np.column_stack(
        [cloth.fabric, *own, *(np.where(w, g, 0.0) for w, g in zip(own, given, strict=True))]
    )
    kinds, kind = np.unique(rows, axis=0, return_inverse=True)
    count = len(kinds)
    material = np.full(len(cloth.positions) + avatar_vertices, count, np.int32)
    np.minimum.at(material, cloth.face_nodes.ravel(), np.repeat(kind.ravel().astype(np.int32), 3))
    table = np.zeros((count + 1, count + 1))
    for i, (fabric, on_body, on_self, body, _) in enumerate(kinds.tolist()):
        one = cloth.fabrics[int(fabric)]
        usual = named.get(frozenset((one.name, BODY)), one.friction_body)
        table[i, count] = table[count, i] = body if on_body else usual
        for j, (other_fabric, _, other_on_self, _, _) in enumerate(kinds.tolist()):
            other = cloth.fabrics[int(other_fabric)]
            if on_self or other_on_self:
                table[i, j] = np.sqrt(_on_self(one, kinds[i]) * _on_self(other, kinds[j]))
            else:
                table[i, j] = named.get(frozenset((one.name, other.name)), _mean(one, other))
    return PairFriction(material, table)


def _on_self(fabric: Fabric, kind: Float) -> float:
    return float(kind[4]) if kind[2] else fabric.friction_self


def _mean(one: Fabric, other: Fabric) -> float:
    return one.friction_self if one is other else float(np.sqrt(one.friction_self * other.friction_self))
