"""Contact properties of cloth: thickness of every node, friction of every pair of materials."""

from collections.abc import Mapping

import numpy as np

from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fabric import Fabric
from toile.engine.forces.contact import PairFriction
from toile.geometry.arrays import Float

BODY = "body"
"""Name of the avatar's surface beside those of fabrics."""


def node_thickness(cloth: Cloth) -> Float:
    """Thickness of the thickest fabric at every node [m], shape (n,)."""
    thickness = np.zeros(len(cloth.positions))
    per_face = np.array([fabric.thickness for fabric in cloth.fabrics])[cloth.fabric]
    np.maximum.at(thickness, cloth.face_nodes.ravel(), np.repeat(per_face, 3))
    return thickness


def pair_friction(cloth: Cloth, avatar_vertices: int, named: Mapping[frozenset[str], float]) -> PairFriction:
    """Return friction between the fabrics of a cloth and an avatar of so many vertices.

    `named` gives coefficients of pairs of fabrics, or of a fabric and BODY, by their names. Else a fabric has
    its own on the body and on itself, and two fabrics have the geometric mean of theirs.
    """
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


def _mean(one: Fabric, other: Fabric) -> float:
    return one.friction_self if one is other else float(np.sqrt(one.friction_self * other.friction_self))
