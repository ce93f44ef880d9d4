"""Patterns drafted to a body: those built in, and those that `toile.register_draft` adds."""

import re
from collections.abc import Callable

from toile.dressing.body.measurements import Measurements
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.pattern.drafts.circle_skirt import draft_circle_skirt
from toile.dressing.pattern.drafts.trousers import draft_trousers
from toile.dressing.pattern.drafts.tshirt import draft_tshirt
from toile.dressing.pattern.garmentcode import check_pattern
from toile.dressing.pattern.pattern import Pattern
from toile.geometry.errors import InputError

Drafter = Callable[[Measurements], Pattern]
"""Takes the measurements of a body and returns a pattern that is placed around it."""

_DRAFTS: dict[str, Drafter] = {
    "circle_skirt": draft_circle_skirt,
    "trousers": draft_trousers,
    "tshirt": draft_tshirt,
}


def register_draft(name: str, draft: Drafter) -> None:
    """Add a draft: scenes of this process may name it as a garment's source, like a built-in one.

    Parameters
    ----------
    name
        Lower-case letters, digits and underscores, such as "apron".
    draft
        Takes the measurements of the body [m] and returns the pattern, which is checked before it is used.

    Raises
    ------
    InputError
        If the name is of another kind, or if there is another draft of that name.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise InputError(
            f"register_draft: {name!r} is no name for a draft; use lower-case letters, digits and underscores"
        )
    plain = name.replace("_", "")
    taken = next((known for known in _DRAFTS if known.replace("_", "") == plain), None)
    if taken is not None and (taken != name or _DRAFTS[taken] is not draft):
        raise InputError(f"register_draft: there is a draft '{taken}' already; choose another name")
    _DRAFTS[name] = draft


def built_in_names() -> tuple[str, ...]:
    """Return the names that `built_in` knows, sorted."""
    return tuple(sorted(_DRAFTS))


def built_in(name: str, measurements: Measurements) -> Pattern:
    """Return a built-in or registered pattern, drafted to the measurements.

    Upper case, spaces and hyphens do not matter.

    Raises
    ------
    InputError
        If there is no pattern of that name (the nearest names are given), or if the measurements are
        not those of an upright body, or if the pattern cannot be sewn.
    """
    key = name.strip().lower().replace("-", "_").replace(" ", "_")
    draft = _DRAFTS.get(key) or _DRAFTS.get(key.replace("_", ""))
    if draft is None:
        raise InputError(unknown_name("built-in pattern", name, built_in_names()), field="name")
    pattern = draft(measurements)
    check_pattern(pattern)
    return pattern
