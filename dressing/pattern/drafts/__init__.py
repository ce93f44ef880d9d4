"""Built-in patterns, drafted to a body."""

from collections.abc import Callable

from toile.dressing.body.measurements import Measurements
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.pattern.drafts.circle_skirt import draft_circle_skirt
from toile.dressing.pattern.drafts.trousers import draft_trousers
from toile.dressing.pattern.drafts.tshirt import draft_tshirt
from toile.dressing.pattern.pattern import Pattern
from toile.geometry.errors import InputError

_DRAFTS: dict[str, Callable[[Measurements], Pattern]] = {
    "circle_skirt": draft_circle_skirt,
    "trousers": draft_trousers,
    "tshirt": draft_tshirt,
}


def built_in_names() -> tuple[str, ...]:
    """Return the names that `built_in` knows, sorted."""
    return tuple(sorted(_DRAFTS))


def built_in(name: str, measurements: Measurements) -> Pattern:
    """Return a built-in pattern, drafted to the measurements.

    Upper case, spaces and hyphens do not matter.

    Raises
    ------
    InputError
        If there is no pattern of that name (the nearest names are given), or if the measurements are
        not those of an upright body.
    """
    key = name.strip().lower().replace("-", "_").replace(" ", "_")
    draft = _DRAFTS.get(key) or _DRAFTS.get(key.replace("_", ""))
    if draft is None:
        raise InputError(unknown_name("built-in pattern", name, built_in_names()), field="name")
    return draft(measurements)
