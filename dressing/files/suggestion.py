"""Suggestions for misspelt names."""

import difflib
from collections.abc import Iterable


def unknown_name(kind: str, name: str, known: Iterable[str]) -> str:
    """Return one line: the unknown name and the nearest known ones (all of them if none is near)."""
    name = " ".join(name.split())[:60]
    choices = list(known)
    lowered = {choice.lower(): choice for choice in choices}
    near = [lowered[word] for word in difflib.get_close_matches(name.lower(), lowered, n=3, cutoff=0.5)]
    if not near:
        near = [choice for choice in choices if name and name.lower() in choice.lower()][:3]
    if near:
        return f"unknown {kind} '{name}'; did you mean {' or '.join(repr(choice) for choice in near)}?"
    return f"unknown {kind} '{name}'; known are: {', '.join(choices)}"
