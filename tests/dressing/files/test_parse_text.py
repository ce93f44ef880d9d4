"""Texts of users that Python's parsers refuse in ways of their own are refused in one."""

from collections.abc import Callable
from typing import Any

import pytest

from toile.dressing.files.parse_text import parse_json, parse_toml


@pytest.mark.parametrize(
    ("parse", "text", "said"),
    [
        (parse_json, '{"a": }', "line 1 column 7"),
        (parse_json, "[" * 100_000, "nested too deeply"),
        (parse_json, "9" * 5000, "thousands of digits"),
        (parse_toml, "a = \nb = 1", "line 1"),
        (parse_toml, "a = " + "[" * 5000, "nested too deeply"),
        (parse_toml, "a = " + "9" * 5000, "thousands of digits"),
    ],
)
def test_every_fault_is_a_value_error_of_one_line(parse: Callable[[str], Any], text: str, said: str) -> None:
    with pytest.raises(ValueError, match=said) as raised:
        parse(text)
    assert "\n" not in str(raised.value)


def test_what_is_valid_is_read() -> None:
    assert parse_json(b'{"a": [1, 2.5]}') == {"a": [1, 2.5]}
    assert parse_toml("a = [1, 2.5]") == {"a": [1, 2.5]}
