"""Seams between runs: lists of edges or parts of edges, as people write them down.

In text, `front.3 + back.2[0.5:] = sleeve.1` sews two edges of one side to one of the other. What stands left
of "=" is walked along its panels' loops, what stands right of it against them, so that right sides face each
other; a "-" in front of an edge turns it around. `[0.2:0.8]` takes a part, in fractions of the edge's length.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from toile.geometry.errors import InputError

_PART = re.compile(
    r"(?P<turn>-?)\s*(?P<panel>.*\S)\s*\.\s*(?P<edge>\d{1,9})\s*(?:\[(?P<from>[^:\]]*):(?P<to>[^:\]]*)\])?"
)


@dataclass(frozen=True)
class EdgePart:
    """A stretch of an edge, walked from one fraction of its length to another.

    Attributes
    ----------
    panel, edge
        The edge.
    start, end
        Where the walk starts and ends, as fractions of the edge's length; from 1 to 0 it runs against the
        loop.
    """

    panel: str
    edge: int
    start: float = 0.0
    end: float = 1.0

    def turned(self) -> "EdgePart":
        """Return the same stretch walked the other way."""
        return EdgePart(self.panel, self.edge, self.end, self.start)

    @property
    def name(self) -> str:
        """Such as "front.3", or "front.3[0.2:0.8]" for a part."""
        low, high = sorted((self.start, self.end))
        return f"{self.panel}.{self.edge}" + ("" if (low, high) == (0.0, 1.0) else f"[{low:.4g}:{high:.4g}]")


@dataclass(frozen=True)
class Seam:
    """Two runs that are sewn together: the walks of `a` and of `b` start together and end together."""

    a: tuple[EdgePart, ...]
    b: tuple[EdgePart, ...]

    @property
    def name(self) -> str:
        """Such as "front.3 + back.2 = sleeve.1"."""
        return _side_text(self.a, forwards=True) + " = " + _side_text(self.b, forwards=False)


def read_seam(text: str, where: str = "seam") -> Seam:
    """Return the seam of a text. Raises InputError, beginning with `where`, if it cannot be read."""
    if not isinstance(text, str):
        raise InputError(f"{where}: a seam is a text such as 'front.3 + back.2 = sleeve.1', got {text!r}")
    sides = text.split("=")
    if len(sides) != 2 or not all(side.strip() for side in sides):
        count = "more than two sides" if len(sides) > 2 else "only one side"
        raise InputError(
            f"{where}: seam '{text.strip()}' has {count}; write two, such as 'front.3 + back.2 = sleeve.1'"
        )
    return Seam(_side(sides[0], where, forwards=True), _side(sides[1], where, forwards=False))


def read_run(text: str, where: str = "run") -> tuple[EdgePart, ...]:
    """Return the edges of a text such as "front.3 + back.2[0.5:1]". Raises InputError as `read_seam` does."""
    return _side(text, where, forwards=True)


def _side(text: str, where: str, *, forwards: bool) -> tuple[EdgePart, ...]:
    return tuple(_part(part.strip(), where, forwards) for part in text.split("+"))


def _part(text: str, where: str, forwards: bool) -> EdgePart:
    found = _PART.fullmatch(text)
    if found is None:
        raise InputError(
            f"{where}: '{text}' is no edge; write PANEL.NUMBER, such as front.3 or front.3[0.2:0.8]"
        )
    try:
        low = float(found["from"] or 0.0)
        high = float(found["to"] or 1.0)
    except ValueError:
        raise InputError(f"{where}: '{text}': a part is two fractions, such as [0.2:0.8]") from None
    if not 0.0 <= low < high <= 1.0:
        raise InputError(f"{where}: '{text}': a part runs from a smaller to a larger fraction within 0 and 1")
    part = EdgePart(found["panel"], int(found["edge"]), low, high)
    return part if forwards != bool(found["turn"]) else part.turned()


def _side_text(parts: Iterable[EdgePart], *, forwards: bool) -> str:
    return " + ".join(("" if (part.start < part.end) == forwards else "-") + part.name for part in parts)
