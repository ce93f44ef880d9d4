"""Seams that are sewn the wrong way round are named before anything is sewn."""

from dataclasses import replace

import pytest

from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.pattern.drafts import built_in
from toile.dressing.pattern.garmentcode_loops import reversed_loop
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.twisted_seams import check_twists, twisted_seam
from toile.geometry.errors import InputError


@pytest.fixture(scope="module")
def tshirt() -> Pattern:
    found = built_in("tshirt", DressForm(mannequin()).measurements)
    assert isinstance(found, Pattern)
    return found


def test_a_right_pattern_passes(tshirt: Pattern) -> None:
    assert twisted_seam(tshirt) is None
    check_twists(tshirt)


@pytest.mark.parametrize("number", range(12))
def test_every_single_twisted_seam_is_named(tshirt: Pattern, number: int) -> None:
    """A seam that closes a circle of panels: its half turn leaves the shirt without a right side."""
    stitches = list(tshirt.stitches)
    stitches[number] = replace(stitches[number], right_wrong=True)
    with pytest.raises(
        InputError, match=rf'stitch {number} \({stitches[number].name}\) twists.*"right_wrong"'
    ):
        check_twists(replace(tshirt, stitches=tuple(stitches)))


def test_a_panel_turned_over_is_found_by_where_its_ends_lie(tshirt: Pattern) -> None:
    count = len(tshirt.panel("back").edges)
    panels = tuple(reversed_loop(panel) if panel.name == "back" else panel for panel in tshirt.panels)
    stitches = tuple(
        replace(stitch, edge_b=count - 1 - stitch.edge_b) if stitch.panel_b == "back" else stitch
        for stitch in tshirt.stitches
    )
    with pytest.raises(InputError, match="its ends lie crosswise"):
        check_twists(replace(tshirt, panels=panels, stitches=stitches))
