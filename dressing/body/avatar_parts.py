"""Which faces of a file are the body: parts chosen by name, and what no body has left out and said.

Files hold more than a body: a floor, hair and lashes, helpers and joints of MakeHuman, a second copy of every
face that looks inwards. What is closed, such as eyes and teeth, is united with the body later.
"""

import re
from collections.abc import Sequence
from fnmatch import fnmatchcase

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from toile.dressing.files.corner_surface import Surface
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected, connected_vertices
from toile.geometry.errors import InputError

NO_BODY = re.compile(
    r"(^|[^a-z])(helpers?|joints?|(eye)?lash(es)?|(eye)?brows?|hairs?|haircards?|floor|ground|backdrop)([^a-z]|$)"
)
"""Names, in lower case, of parts that are no body."""
BODY_SHARE = 0.6
"""Parts are left out by name where another as tall as this share of the whole remains."""
FLAT = 1e-5
"""A part thinner than this share of its size is flat."""
LARGE = 0.1
"""Flat parts are left out here from this share of the size of the whole on; loose triangles, which may belong
to the skin, are judged where it is closed."""
SLAB = 0.05
"""A floor is thinner than this share of its width, and lies below this share of the body's height."""
ROUNDED = 1e-6
"""Second copies of faces lie within this share of the size of the whole: text files round their digits."""
NAMED = 6
"""Names that a note lists at most."""


def body_faces(
    file_name: str, surface: Surface, only: Sequence[str] = (), without: Sequence[str] = ()
) -> tuple[Bool, tuple[str, ...]]:
    """Return which faces of a file are the body, shape (t,), and notes on what is not.

    Parameters
    ----------
    file_name
        Name of the file, for messages.
    surface
        What it holds, in its units.
    only, without
        Names of parts, with wildcards; where `only` is given, all of those are the body.

    Raises
    ------
    InputError
        If no part has one of the names, or none remains.
    """
    names = surface.panel_names
    chosen = ~_matching(file_name, names, without, "without")
    if only:
        chosen &= _matching(file_name, names, only, "only")
    kept = chosen[surface.panel]
    if not len(kept):
        return kept, ()
    if not kept.any():
        raise InputError(f"{file_name}: no part remains; name fewer of them in without", field="without")
    notes: list[str] = []
    if only or without:
        notes.append(f"Parts read: {_listed(np.array(names)[chosen].tolist())}.")
    if not np.isfinite(surface.positions[surface.faces[kept]]).all():
        # Which vertices are at fault is said where they are all read.
        return kept, tuple(notes)
    if not only:
        kept = _without_named(surface, kept, notes)
        kept = _without_flat(surface, kept, notes)
    return _without_copies(surface, kept, notes), tuple(notes)


def _matching(file_name: str, names: tuple[str, ...], words: Sequence[str], field: str) -> Bool:
    """Return which parts have one of the names. Raises InputError for a name that no part has."""
    found = np.zeros(len(names), np.bool_)
    for word in words:
        plain = word.lower()
        # Names may have brackets in them, which are wildcards.
        hit = np.array([name.lower() == plain or fnmatchcase(name.lower(), plain) for name in names])
        if not hit.any():
            known = f"it has {_listed(names, limit=20)}" if len(names) > 1 else "its parts have no names"
            raise InputError(f"{file_name}: has no part {word!r}; {known}", field=field)
        found |= hit
    return found


def _listed(names: Sequence[str], limit: int = NAMED) -> str:
    """Return names, the first of many."""
    more = f" and {len(names) - limit} more" if len(names) > limit else ""
    return ", ".join(names[:limit]) + more


def _without_named(surface: Surface, kept: Bool, notes: list[str]) -> Bool:
    """Leave out parts whose names say that they are no body, where another part is one.

    What is joined to others is a patch of skin, whatever the name of its material.
    """
    suspect = np.array([NO_BODY.search(name.lower()) is not None for name in surface.panel_names])
    out = suspect[surface.panel] & kept
    if not out.any() or not (kept & ~out).any():
        return kept
    piece = _pieces(surface.positions, surface.faces[kept])
    skin = np.unique(piece[~out[kept]])
    out[kept] &= ~np.isin(piece, skin)
    if not out.any():
        return kept
    flat = kept & ~_flat_faces(surface, kept)
    whole, rest = (_extent(surface.positions[surface.faces[which].ravel()]) for which in (flat, flat & ~out))
    if not (rest >= BODY_SHARE * whole).any() or rest.max(initial=0.0) < BODY_SHARE * whole.max():
        return kept
    names = [surface.panel_names[panel] for panel in np.unique(surface.panel[out]).tolist()]
    parts = "1 part that is" if len(names) == 1 else f"{len(names)} parts that are"
    notes.append(f"{parts} no body by name left out: {_listed(names)} (give only to keep them).")
    return kept & ~out


def _extent(points: Float) -> Float:
    """Size of the box of points, shape (3,); zero without any."""
    return np.ptp(points, axis=0) if len(points) else np.zeros(3)


def _flat_faces(surface: Surface, kept: Bool) -> Bool:
    """Which of the kept faces belong to large connected parts that are flat, shape (t,)."""
    flat = np.zeros(len(kept), np.bool_)
    rows = np.flatnonzero(kept)
    for own in _large_pieces(surface, rows):
        points = surface.positions[np.unique(surface.faces[rows[own]])]
        size = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
        flat[rows[own]] = size[-1] <= FLAT * size[0]
    return flat


def _large_pieces(surface: Surface, rows: npt.NDArray[np.int64]) -> list[npt.NDArray[np.int64]]:
    """Return connected parts of some faces that are not small beside all of them, as numbers of rows."""
    if not len(rows):
        return []
    corners = surface.positions[surface.faces[rows]]
    members = _members(_pieces(surface.positions, surface.faces[rows]))
    order = np.concatenate(members)
    starts = np.cumsum([0, *map(len, members[:-1])])
    low = np.minimum.reduceat(corners.min(axis=1)[order], starts)
    high = np.maximum.reduceat(corners.max(axis=1)[order], starts)
    large = (high - low).max(axis=1) >= LARGE * (high.max(axis=0) - low.min(axis=0)).max()
    return [own for own, is_large in zip(members, large, strict=True) if is_large]


def _without_flat(surface: Surface, kept: Bool, notes: list[str]) -> Bool:
    """Leave out flat parts and floors, which are larger than the body that stands on them."""
    out = _flat_faces(surface, kept)
    rows = np.flatnonzero(kept & ~out)
    if not len(rows):
        # All of it is flat, which is said where the surface is closed.
        return kept
    for own in _large_pieces(surface, rows):
        points = surface.positions[np.unique(surface.faces[rows[own]])]
        sizes = np.sort(_extent(points))
        if sizes[0] < SLAB * sizes[1] and len(own) < len(rows):
            others = np.setdiff1d(np.arange(len(rows)), own)
            rest = surface.positions[np.unique(surface.faces[rows[others]])]
            out[rows[own]] = _is_floor(points, rest)
    if not out.any():
        return kept
    count = len(_members(_pieces(surface.positions, surface.faces[out & kept])))
    parts = "1 flat part was" if count == 1 else f"{count} flat parts were"
    notes.append(f"{parts} left out: a floor or a card is no body.")
    return kept & ~out


def _is_floor(points: Float, rest: Float) -> bool:
    """Whether points are a slab that the rest stands on, along y or z."""
    low, high = points.min(axis=0), points.max(axis=0)
    for up in (1, 2):
        across = [axis for axis in range(3) if axis != up]
        tall = float(np.ptp(rest[:, up]))
        thick, wide = high[up] - low[up], (high - low)[across]
        stands = rest[:, up].min() > high[up] - SLAB * tall
        covers = (wide > 0.5 * np.ptp(rest[:, across], axis=0)).all()
        if thick < SLAB * wide.min() and stands and covers and tall > thick:
            return True
    return False


def _places(positions: Float) -> npt.NDArray[np.int64]:
    """Return the same number for vertices at the same place, shape (n,)."""
    # + 0.0 makes -0.0 and 0.0 the same bytes.
    return np.unique(positions + 0.0, axis=0, return_inverse=True)[1].reshape(-1)


def _rounded_places(positions: Float) -> Int:
    """Return the same number for vertices and their nearest ones within rounding, shape (n,)."""
    points, place = np.unique(positions + 0.0, axis=0, return_inverse=True)
    reach = ROUNDED * float(np.ptp(points, axis=0).max())
    nearest = np.asarray(cKDTree(points).query(points, k=2, distance_upper_bound=reach)[1])
    # Where no other is near, the second nearest has no number.
    pairs = nearest[nearest[:, 1] < len(points)]
    return connected(pairs, len(points))[place.reshape(-1)]


def _pieces(positions: Float, faces: Int) -> Int:
    """Return the connected part of every face, shape (f,); vertices at the same place are one."""
    used, local = np.unique(faces, return_inverse=True)
    corners = _places(positions[used])[local.reshape(-1, 3)]
    return connected_vertices(corners, int(corners.max()) + 1)[corners[:, 0]]


def _members(piece: Int) -> list[npt.NDArray[np.int64]]:
    """Return the rows of every piece."""
    order = np.argsort(piece, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(piece[order])) + 1)


def _without_copies(surface: Surface, kept: Bool, notes: list[str]) -> Bool:
    """Leave out patches all of whose faces lie on faces before them: the other side, or a second copy."""
    rows = np.flatnonzero(kept)
    if not len(rows):
        return kept
    used, local = np.unique(surface.faces[rows], return_inverse=True)
    local, count = local.reshape(-1, 3), len(used)
    corners = np.sort(_rounded_places(surface.positions[used])[local], axis=1)
    _, first, inverse = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    copy = first[inverse.reshape(-1)] != np.arange(len(rows))
    if not copy.any():
        return kept
    patch = connected_vertices(local, count)[local[:, 0]]
    whole = np.bincount(patch, weights=~copy, minlength=count) == 0
    out = whole[patch]
    if not out.any():
        return kept
    notes.append(f"{int(out.sum())} faces that lie on others, the same or turned over, were left out.")
    kept = kept.copy()
    kept[rows[out]] = False
    return kept
