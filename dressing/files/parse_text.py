"""JSON and TOML of users: whatever is wrong with it is a ValueError, deep nesting and huge numbers too."""

import json
import tomllib
from collections.abc import Callable
from typing import Any


def parse_json(text: str | bytes) -> Any:
    """Return what JSON holds. Raises ValueError that says in a line what is wrong."""
    return _parsed(json.loads, text)


def parse_toml(text: str) -> dict[str, Any]:
    """Return what TOML holds. Raises ValueError that says in a line what is wrong."""
    found: dict[str, Any] = _parsed(tomllib.loads, text)
    return found


def _parsed(parse: Callable[[Any], Any], text: str | bytes) -> Any:
    try:
        return parse(text)
    except RecursionError:
        raise ValueError("its brackets are nested too deeply") from None
    except ValueError as error:
        if "integer string conversion" in str(error):
            # Python's message gives advice for programmers.
            raise ValueError("a whole number has thousands of digits") from None
        raise
