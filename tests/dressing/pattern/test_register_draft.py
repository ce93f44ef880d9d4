"""A draft that a user registers is found by its name like a built-in one; clashes are errors."""

from dataclasses import replace

import pytest

import toile
from tests.dressing.pattern.test_built_in_patterns import BODY
from toile.dressing.pattern import drafts
from toile.dressing.run.garment_source import built_in_name


@pytest.fixture(autouse=True)
def own_register(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drafts, "_DRAFTS", dict(drafts._DRAFTS))


def square(body: toile.Measurements) -> toile.Pattern:
    """A square as wide as the waist is round."""
    side = body.waist
    corners = ((0.0, 0.0), (side, 0.0), (side, side), (0.0, side))
    edges = tuple(toile.Edge(i, (i + 1) % 4) for i in range(4))
    panel = toile.Panel(name="square", vertices=corners, edges=edges)
    return toile.Pattern(name="square", panels=(panel,), stitches=())


def bow_tie(body: toile.Measurements) -> toile.Pattern:
    """A square whose outline crosses itself."""
    pattern = square(body)
    a, b, c, d = pattern.panels[0].vertices
    return replace(pattern, panels=(replace(pattern.panels[0], vertices=(a, c, b, d)),))


def test_registered_draft_is_a_source_like_built_in_ones() -> None:
    toile.register_draft("my_square", square)

    assert built_in_name("My-Square") == "my_square"
    assert drafts.built_in_names() == ("circle_skirt", "my_square", "trousers", "tshirt")
    assert drafts.built_in("my square", BODY) == square(BODY)


def test_the_same_function_may_be_registered_again() -> None:
    toile.register_draft("square", square)
    toile.register_draft("square", square)
    assert drafts.built_in("square", BODY).panels[0].vertices[1] == (BODY.waist, 0.0)


@pytest.mark.parametrize("name", ["tshirt", "t_shirt", "circleskirt"])
def test_a_name_that_is_taken_is_an_error(name: str) -> None:
    with pytest.raises(toile.InputError, match=r"there is a draft '(tshirt|circle_skirt)' already"):
        toile.register_draft(name, square)


@pytest.mark.parametrize("name", ["", "My Square", "square.json", "_square"])
def test_a_name_that_no_scene_could_say_is_an_error(name: str) -> None:
    with pytest.raises(toile.InputError, match="no name for a draft"):
        toile.register_draft(name, square)


def test_what_a_draft_draws_is_checked() -> None:
    toile.register_draft("bow_tie", bow_tie)
    with pytest.raises(toile.InputError, match="panel 'square' crosses itself"):
        drafts.built_in("bow_tie", BODY)
