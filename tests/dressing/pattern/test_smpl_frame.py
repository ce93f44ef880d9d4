"""Patterns in the frame of SMPL are moved up; all others stay where they are."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.dressing.pattern.test_built_in_patterns import BODY
from toile.dressing.pattern.drafts import built_in, built_in_names
from toile.dressing.pattern.garmentcode import read_garmentcode
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.smpl_frame import ORIGIN_HEIGHT, on_the_floor

STANDING = np.array([[0.0, 0.0, 0.0], [0.0, BODY.height, 0.0]])


def lowered(pattern: Pattern, by: float) -> Pattern:
    panels = tuple(
        replace(p, translation=(p.translation[0], p.translation[1] - by, p.translation[2]))
        for p in pattern.panels
    )
    return replace(pattern, panels=panels)


@pytest.mark.parametrize("name", ["trousers", "tshirt"])
def test_low_patterns_are_moved_up(name: str) -> None:
    drafted = built_in(name, BODY)
    low = lowered(drafted, ORIGIN_HEIGHT * BODY.height)
    moved = on_the_floor(low, STANDING)
    for panel, wanted in zip(moved.panels, drafted.panels, strict=True):
        assert panel.translation == pytest.approx(wanted.translation)
    assert "SMPL" in moved.notes[-1]
    # About a body with its own origin at the chest it lies right.
    assert on_the_floor(low, STANDING - [0.0, ORIGIN_HEIGHT * BODY.height, 0.0]) is low


@pytest.mark.parametrize("name", built_in_names())
def test_patterns_on_the_body_stay(name: str) -> None:
    drafted = built_in(name, BODY)
    assert on_the_floor(drafted, STANDING) is drafted


def test_patterns_of_garmentcode_stay(data_dir: Path) -> None:
    for path in sorted((data_dir / "patterns").glob("*_specification.json")):
        pattern = read_garmentcode(path)
        assert on_the_floor(pattern, STANDING) is pattern, path.name


def test_the_shirt_of_pygarment_is_read_and_stays() -> None:
    pattern = read_garmentcode(
        Path(__file__).parent / "drawn" / "samples" / "pygarment202_t-shirt_specification.json"
    )
    assert (len(pattern.panels), len(pattern.stitches)) == (8, 16)
    assert not pattern.notes
    assert on_the_floor(pattern, STANDING) is pattern
