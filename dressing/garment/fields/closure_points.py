"""Where the pairs of closures lie on the mesh of a pattern."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from toile.dressing.garment.fields.closure import DISTANCE, MOST, STIFFNESS, Closure
from toile.dressing.garment.fields.runs import border_names, called_borders, is_within
from toile.dressing.garment.garment_mesh import Border, GarmentMesh
from toile.dressing.pattern.seam import EdgePart, read_run
from toile.engine.cloth.fields.fastenings import Fastening
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

SPACING = 0.005
"""Distance of the pairs that stand for a zip [m], at most."""
SLACK = 1e-6
"""Points closer than this are one [m]."""
ALIKE = 0.05
"""Edges of a closure may differ in length by this share: the longer one is eased in."""


class RunLine(NamedTuple):
    """A run of edges as a line in pattern coordinates.

    Attributes
    ----------
    panel
        Number of its panel.
    points
        From where it begins [m], shape (k, 2).
    inward
        1 if the panel lies on its left, -1 if on its right.
    """

    panel: int
    points: Float
    inward: float

    @property
    def length(self) -> float:
        """Its length [m]."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())

    def at(self, shares: Float, inset: float) -> Float:
        """Points at shares of its length, moved into the panel by an inset [m], shape (n, 2)."""
        ways = np.diff(self.points, axis=0)
        lengths = np.linalg.norm(ways, axis=1)
        begin = np.concatenate([[0.0], np.cumsum(lengths)])
        where = np.clip(shares, 0.0, 1.0) * begin[-1]
        piece = np.clip(np.searchsorted(begin, where, side="right") - 1, 0, len(ways) - 1)
        along = ways[piece] / lengths[piece][:, None]
        left = np.stack([-along[:, 1], along[:, 0]], axis=1)
        on = self.points[piece] + (where - begin[piece])[:, None] * along
        return np.asarray(on + self.inward * inset * left)


def run_line(run: str, mesh: GarmentMesh, name: str) -> RunLine:
    """Return a run, walked along the loop of its panel, as a line; `name` is its field, for errors.

    Raises InputError if there is none, or if it is not one line of one panel.
    """
    if not mesh.borders:
        raise InputError("closure: needs a pattern; a mesh has no numbered edges", field=name)
    named = [(border, False) for border in called_borders(run, mesh)]
    if not named:
        if "." not in run:
            raise InputError(
                f"closure: no edges are called '{run}', only {', '.join(border_names(mesh)) or 'none'}; or "
                "write PANEL.NUMBER",
                field=name,
            )
        named = [entry for part in read_run(run, name) for entry in _pieces(mesh.borders, part)]
    panels = {border.panel for border, _ in named}
    if len(panels) != 1:
        raise InputError(
            f"closure: '{run}' must be edges of one panel, found {sorted(panels) or 'none'}; see toile "
            "pattern FILE",
            field=name,
        )
    turned = {back for _, back in named}
    lines = [mesh.uv[border.vertices[::-1] if back else border.vertices] for border, back in named]
    gaps = [float(np.linalg.norm(after[0] - before[-1])) for before, after in pairwise(lines)]
    if len(turned) != 1 or max(gaps, default=0.0) > SLACK:
        raise InputError(f"closure: the edges of '{run}' do not follow each other", field=name)
    points = np.concatenate([lines[0][:1], *(line[1:] for line in lines)])
    return RunLine(mesh.panel_names.index(named[0][0].panel), points, -1.0 if turned.pop() else 1.0)


def _pieces(borders: tuple[Border, ...], part: EdgePart) -> list[tuple[Border, bool]]:
    """Return the pieces of a stretch of an edge in the order in which it is walked, and if backwards."""
    found = [border for border in borders if is_within(border, part)]
    back = part.start > part.end
    return [(border, back) for border in sorted(found, key=lambda one: one.start, reverse=back)]


def fastening_of(closure: Closure, mesh: GarmentMesh) -> Fastening:
    """Return a closure as the engine takes it, on the pattern coordinates of a mesh.

    Raises InputError naming the field at fault.
    """
    over, under = run_line(closure.over, mesh, "over"), run_line(closure.under, mesh, "under")
    # Against the loop, as the second side of a seam.
    under = RunLine(under.panel, under.points[::-1], -under.inward)
    long, short = max(over.length, under.length), min(over.length, under.length)
    if long > (1.0 + ALIKE) * short:
        raise InputError(
            f"closure: '{closure.over}' is {100 * over.length:.1f} cm long and '{closure.under}' "
            f"{100 * under.length:.1f} cm; name edges, or parts of edges, of one length",
            field="under",
        )
    is_zip = closure.kind == "zip"
    count = max(int(np.ceil(long / SPACING)), 2) if is_zip else int(closure.count or 1)
    sides = [line.at(_shares(count, closure.ends, line.length), closure.inset) for line in (over, under)]
    each = long / count if is_zip else 1.0
    stiffness = STIFFNESS[closure.kind] if closure.stiffness is None else closure.stiffness
    most = MOST[closure.kind] if closure.most is None else closure.most
    return Fastening(
        over=(0, over.panel), under=(0, under.panel),
        over_points=np.pad(sides[0], ((0, 0), (0, 1))), under_points=np.pad(sides[1], ((0, 0), (0, 1))),
        side=0 if is_zip else -1 if closure.wrong_side else 1,
        distance=DISTANCE[closure.kind] if closure.distance is None else closure.distance,
        stiffness=np.full(count, each * stiffness), most=np.full(count, each * most), closed=closure.closed,
    )  # fmt: skip


def _shares(count: int, ends: float | None, length: float) -> Float:
    """Return where pairs are on a line of a length [m], as shares of it, shape (count,)."""
    if ends is None:
        return np.asarray((np.arange(count) + 0.5) / count)
    if 2.0 * ends > length + SLACK:
        raise InputError(
            f"closure: ends of {100 * ends:.1f} cm do not fit on an edge of {100 * length:.1f} cm",
            field="ends",
        )
    return np.linspace(ends / length, 1.0 - ends / length, count) if count > 1 else np.array([0.5])
