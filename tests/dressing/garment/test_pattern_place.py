"""Patterns without units, about another origin, or without placement find the body."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.garment.pattern_place import moved_to_body
from toile.dressing.garment.unplaced import placed_by_seams
from toile.dressing.pattern.drafts import built_in
from toile.dressing.pattern.garmentcode import read_garmentcode
from toile.dressing.pattern.garmentcode_write import write_garmentcode
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.pattern_outline import to_world
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError


@pytest.fixture(scope="module")
def form() -> DressForm:
    return DressForm(mannequin())


@pytest.fixture(scope="module")
def tshirt(form: DressForm) -> Pattern:
    found = built_in("tshirt", form.measurements)
    assert isinstance(found, Pattern)
    return found


def changed(folder: Path, pattern: Pattern, change: Callable[[dict[str, Any]], None]) -> Pattern:
    """Write a pattern, change its document, and read it again."""
    path = folder / "shirt_specification.json"
    write_garmentcode(pattern, path)
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))
    return read_garmentcode(path)


def corners(pattern: Pattern) -> Float:
    return np.concatenate([to_world(panel, np.array(panel.vertices)) for panel in pattern.panels])


def test_millimetres_are_recognised(tmp_path: Path, tshirt: Pattern) -> None:
    def change(document: dict[str, Any]) -> None:
        del document["properties"]["units_in_meter"]
        for panel in document["pattern"]["panels"].values():
            panel["vertices"] = [[10.0 * x, 10.0 * y] for x, y in panel["vertices"]]
            panel["translation"] = [10.0 * t for t in panel["translation"]]

    found = changed(tmp_path, tshirt, change)
    assert found.notes == ("The pattern does not say its units; millimetres are assumed.",)
    assert corners(found) == pytest.approx(corners(tshirt), abs=1e-9)


@pytest.mark.parametrize("shift", [(0.0, -0.92, 0.0), (2.0, 0.5, -1.0)])
def test_another_origin_is_recognised(
    tmp_path: Path, tshirt: Pattern, form: DressForm, shift: tuple[float, float, float]
) -> None:
    def change(document: dict[str, Any]) -> None:
        for panel in document["pattern"]["panels"].values():
            panel["translation"] = [t + 100.0 * s for t, s in zip(panel["translation"], shift, strict=True)]

    found = moved_to_body(changed(tmp_path, tshirt, change), form)
    assert "another origin" in found.notes[-1]
    # Its collar starts a little lower than that of the draft, and in depth it is centred on the trunk.
    assert np.abs(corners(found) - corners(tshirt)).max() < 0.08
    assert moved_to_body(tshirt, form) is tshirt


def test_panels_without_places_are_laid_around_the_body(
    tmp_path: Path, tshirt: Pattern, form: DressForm
) -> None:
    def change(document: dict[str, Any]) -> None:
        for panel in document["pattern"]["panels"].values():
            panel["translation"] = panel["rotation"] = [0, 0, 0]

    bare = changed(tmp_path, tshirt, change)
    found = placed_by_seams(bare, form)
    assert np.abs(corners(found) - corners(tshirt)).max() < 0.09
    assert "does not place its panels" in found.notes[-1]
    assert placed_by_seams(tshirt, form) is tshirt


def test_a_panel_that_cannot_be_placed_is_named(tmp_path: Path, tshirt: Pattern, form: DressForm) -> None:
    def change(document: dict[str, Any]) -> None:
        panels = document["pattern"]["panels"]
        for panel in panels.values():
            panel["translation"] = panel["rotation"] = [0, 0, 0]
        document["pattern"]["panels"] = {f"piece_{i}": panel for i, panel in enumerate(panels.values())}
        names = {name: f"piece_{i}" for i, name in enumerate(panels)}
        for stitch in document["pattern"]["stitches"]:
            for side in stitch:
                side["panel"] = names[side["panel"]]
        document["pattern"].pop("panel_order", None)

    with pytest.raises(InputError, match="'piece_0' belongs cannot be told; give every panel a translation"):
        placed_by_seams(changed(tmp_path, tshirt, change), form)
