"""Folds as scene files have them, and panels that get them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.pattern.pattern import Fold, Pattern
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real, shown

KEYS = {"points", "line", "degrees", "stiffness"}


def folds_of(values: Mapping[str, Any]) -> dict[str, tuple[Fold, ...]]:
    """Return the folds of a table: panel to a list of { points = [[x, y], [x, y]], degrees = 180 }.

    Raises InputError for what is no fold.
    """
    return {
        panel: tuple(_fold(panel, entry) for entry in (entries if isinstance(entries, list) else [entries]))
        for panel, entries in values.items()
    }


def _fold(panel: str, values: Any) -> Fold:
    example = "{ points = [[0, 0.1], [0.2, 0.1]], degrees = 180 }"
    if not isinstance(values, dict):
        raise InputError(f"folds of '{panel}' are tables such as {example}, got {values!r}", field="folds")
    for key in values:
        if key not in KEYS:
            raise InputError(f"folds of '{panel}': {unknown_name('key', key, sorted(KEYS))}", field="folds")
    points, line = values.get("points", []), values.get("line")
    numbers = [values.get("degrees", 180.0), values.get("stiffness", 0.0)]
    good = isinstance(points, list) and all(
        isinstance(point, list) and len(point) == 2 and all(_is_number(value) for value in point)
        for point in points
    )
    if not good or not all(_is_number(number) for number in numbers) or bool(points) == (line is not None):
        raise InputError(
            f"folds of '{panel}': {shown(values)} is none; write {example}, or line = 0 for a drawn line",
            field="folds",
        )
    if line is not None and (isinstance(line, bool) or not isinstance(line, int)):
        raise InputError(
            f"folds of '{panel}': line is the number of a drawn line, got {line!r}", field="folds"
        )
    return Fold(
        tuple((float(x), float(y)) for x, y in points), float(numbers[0]),
        None if "stiffness" not in values else float(numbers[1]), line=line,
    )  # fmt: skip


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and is_real(value)


def with_folds(pattern: Pattern, folds: Mapping[str, Sequence[Fold]]) -> Pattern:
    """Return a pattern with folds added to its panels, those along drawn lines with their points.

    Raises InputError if a panel or a line does not exist.
    """
    names = [panel.name for panel in pattern.panels]
    for name in folds:
        if name not in names:
            raise InputError(f"{pattern.name}: folds: {unknown_name('panel', name, names)}", field="folds")
    panels = []
    for panel in pattern.panels:
        own = [*panel.folds, *folds.get(panel.name, ())]
        drawn = []
        for fold in own:
            if fold.line is None:
                drawn.append(fold)
                continue
            if not 0 <= fold.line < len(panel.lines):
                raise InputError(
                    f"{pattern.name}: folds: panel '{panel.name}' has {len(panel.lines)} drawn lines, "
                    f"none of number {fold.line}; give points instead",
                    field="folds",
                )
            drawn.append(replace(fold, points=panel.lines[fold.line], line=None))
        panels.append(replace(panel, folds=tuple(drawn)))
    return replace(pattern, panels=tuple(panels))
