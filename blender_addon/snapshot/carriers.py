"""Which attributes a USD frame carries under their own names, and which under others, for nodes to put back.

Blender's reader of USD takes seven types of attributes, names of letters, digits and underscores, and makes
the first UV map and the first colour the active ones. Everything else travels as numbers and vectors under
names of toile's.
"""

import re
from itertools import count
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Key = tuple[str, str, str]
"""Domain, type and name of an attribute."""

PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
SPECIAL = ("st", "displayColor", "displayOpacity", "normals", "velocity", "velocities")
"""Names that mean something to the reader."""
TRAVELS_AS = {
    "FLOAT": "FLOAT", "INT": "INT", "BOOLEAN": "BOOLEAN", "FLOAT_VECTOR": "FLOAT_VECTOR",
    "FLOAT2": "FLOAT_VECTOR", "INT8": "INT", "QUATERNION": "QUATERNION", "FLOAT_COLOR": "FLOAT_VECTOR",
    "BYTE_COLOR": "FLOAT_VECTOR",
}  # fmt: skip
"""Types that follow, and what they travel as; the alpha of colours travels besides."""
ALPHA = "_a"
"""Ends the name of what carries the alpha of a colour."""


class Carrier(NamedTuple):
    """An attribute that travels under another name: that name and its type, and what it is to become."""

    name: str
    kind: str
    domain: str
    own_name: str
    own_kind: str


class Chosen(NamedTuple):
    """The UV map, or colour, that is active, and the one that renders; empty where there is none."""

    active: str
    renders: str

    def reads_as_such(self, kind: str, attributes: dict[Key, npt.NDArray[Any]]) -> bool:
        """Whether it remains the chosen one if it is read first, as an attribute of that type."""
        same = self.active == self.renders and _is_plain(self.renders)
        return same and any(key[1:] == (kind, self.renders) for key in attributes)


def carried(
    attributes: dict[Key, npt.NDArray[Any]], maps: Chosen, colours: Chosen
) -> tuple[dict[Key, npt.NDArray[Any]], list[Carrier]]:
    """Return attributes as they travel, in the order in which they must be read, and those to be put back."""
    as_such = {kind: True for kind, travels in TRAVELS_AS.items() if kind == travels}
    as_such["FLOAT2"] = maps.reads_as_such("FLOAT2", attributes)
    as_such["FLOAT_COLOR"] = colours.reads_as_such("FLOAT_COLOR", attributes)
    first = ("FLOAT2", maps.renders), ("FLOAT_COLOR", colours.renders)
    taken = {name.removesuffix(ALPHA) for _, _, name in attributes}
    free = (unused for unused in map("toile_{}".format, count()) if unused not in taken)
    travelling: dict[Key, npt.NDArray[Any]] = {}
    carriers: list[Carrier] = []
    for (domain, kind, name), values in sorted(
        attributes.items(), key=lambda entry: entry[0][1:] not in first
    ):
        # What is in two dimensions and no UV map would become one.
        if _is_plain(name) and as_such.get(kind, False) and (kind != "FLOAT2" or domain == "CORNER"):
            travelling[domain, kind, name] = values
            continue
        carrier = Carrier(next(free), TRAVELS_AS[kind], domain, name, kind)
        if kind == "FLOAT2":
            values = np.column_stack([values, np.zeros(len(values), values.dtype)])
        if kind.endswith("COLOR"):
            travelling[domain, "FLOAT", carrier.name + ALPHA] = values[:, 3]
            values = values[:, :3]
        travelling[domain, carrier.kind, carrier.name] = values
        carriers.append(carrier)
    return travelling, carriers


def _is_plain(name: str) -> bool:
    """Whether a name comes through unchanged."""
    return PLAIN.fullmatch(name) is not None and not name.startswith("toile_") and name not in SPECIAL
