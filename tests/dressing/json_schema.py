"""The part of JSON Schema that toile's schemas use: what does not fit, by its path."""

import re
from collections.abc import Iterator
from typing import Any

TYPES: dict[str, Any] = {
    "object": dict, "array": list, "string": str, "number": (int, float), "integer": int, "null": type(None),
}  # fmt: skip
KNOWN = {
    "$schema", "title", "description", "type", "properties", "required", "additionalProperties", "items",
    "enum", "const", "minimum", "minItems", "maxItems", "pattern",
}  # fmt: skip


def misfits(value: Any, schema: dict[str, Any], path: str = "report") -> Iterator[str]:
    """Yield where a value does not fit a schema."""
    assert set(schema) <= KNOWN, set(schema) - KNOWN
    kinds = schema.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    fits = not kinds or any(isinstance(value, TYPES[kind]) for kind in kinds)
    if not fits or (isinstance(value, bool) and kinds):
        yield f"{path}: {value!r} is no {' or '.join(kinds)}"
        return
    if "enum" in schema and value not in schema["enum"]:
        yield f"{path}: {value!r} is none of {schema['enum']}"
    if "const" in schema and value != schema["const"]:
        yield f"{path}: {value!r} is not {schema['const']!r}"
    if "minimum" in schema and value < schema["minimum"]:
        yield f"{path}: {value!r} is below {schema['minimum']}"
    if "pattern" in schema and not re.search(schema["pattern"], value):
        yield f"{path}: {value!r} does not match {schema['pattern']}"
    if isinstance(value, dict) and "object" in kinds:
        yield from _entries(value, schema, path)
    if isinstance(value, list) and "items" in schema:
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{path}: has {len(value)} entries"
        for index, entry in enumerate(value):
            yield from misfits(entry, schema["items"], f"{path}[{index}]")


def _entries(value: dict[str, Any], schema: dict[str, Any], path: str) -> Iterator[str]:
    known = schema.get("properties", {})
    yield from (f"{path}: lacks {key}" for key in schema.get("required", []) if key not in value)
    for key, entry in value.items():
        more = schema.get("additionalProperties", True)
        if key in known:
            yield from misfits(entry, known[key], f"{path}.{key}")
        elif more is False:
            yield f"{path}: {key} is unknown"
        elif isinstance(more, dict):
            yield from misfits(entry, more, f"{path}.{key}")
