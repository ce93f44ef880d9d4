"""Mutations of bytes, of words of text, of JSON and of arrays."""

import copy
import io
import json
import random
import re
import struct
from typing import Any

import numpy as np

WORDS = (
    "nan", "inf", "-inf", "-1", "0", "-0.0", "1", "2", "3", "7", "1e999", "1e308", "-1e308", "1e-320",
    "99999999999",
    "-99999999999", "4294967295", "0.5", "x", "", '"', "true", "null", "[", "]", "{", "}", "é", "\\", "#",
    "/", "//", "[" * 3000, "9" * 5000,
)  # fmt: skip
LARGE = 1e300
VALUES: tuple[Any, ...] = (
    None, True, False, 0, 1, 2, 3, -1, 0.5, -0.5, 1e-300, 1e300, -1e300, 10**12, 2**31, 2**63, 10**400,
    float("nan"), float("inf"), "", "x", "VEC3", [], {}, [0], [[]], [0, 1], [0.0, 0.0, 0.0], {"x": 1},
)  # fmt: skip


def mutated(data: bytes, suffix: str, random_: random.Random) -> bytes:
    """Return a mutation of a valid file, of a kind that its format allows."""
    rounds = random_.choice((1, 1, 1, 2, 4))
    for _ in range(rounds):
        data = random_.choice(MUTATIONS[suffix])(data, random_)
    return data


def bytes_changed(data: bytes, random_: random.Random) -> bytes:
    """Flip, overwrite, cut, repeat or insert some bytes, or end early."""
    if not data:
        return bytes([random_.randrange(256)])
    raw = bytearray(data)
    place = random_.randrange(len(raw))
    length = random_.choice((1, 1, 2, 4, 16))
    kind = random_.randrange(6)
    if kind == 0:
        raw[place] ^= 1 << random_.randrange(8)
    elif kind == 1:
        raw[place : place + length] = random_.randbytes(length)
    elif kind == 2:
        del raw[place : place + length]
    elif kind == 3:
        raw[place:place] = raw[place : place + 16 * length]
    elif kind == 4:
        raw[place:place] = random_.choice((b"\0", b"\xff", b"\xff\xff\xff\x7f", random_.randbytes(length)))
    else:
        del raw[place:]
    return bytes(raw)


def words_changed(data: bytes, random_: random.Random) -> bytes:
    """Replace, drop, repeat or swap words, or lines."""
    text = data.decode("utf-8", errors="replace")
    if random_.random() < 0.3:
        lines = text.splitlines(keepends=True)
        if len(lines) > 1:
            a, b = random_.randrange(len(lines)), random_.randrange(len(lines))
            kind = random_.randrange(3)
            if kind == 0:
                lines[a], lines[b] = lines[b], lines[a]
            elif kind == 1:
                del lines[a]
            else:
                lines.insert(b, lines[a])
            return "".join(lines).encode()
    words = list(re.finditer(r"[\w.+-]+", text))
    if not words:
        return bytes_changed(data, random_)
    word = random_.choice(words)
    other = random_.choice((random_.choice(WORDS), random_.choice(words).group()))
    return (text[: word.start()] + other + text[word.end() :]).encode()


def json_changed(data: bytes, random_: random.Random) -> bytes:
    """Replace, drop or repeat a value somewhere in a JSON document."""
    try:
        document = json.loads(data)
    except (ValueError, RecursionError):
        return bytes_changed(data, random_)
    return json.dumps(tree_changed(document, random_)).encode()


def tree_changed(document: Any, random_: random.Random) -> Any:
    """Return a copy of a tree of lists and dictionaries, one of its values replaced, dropped or repeated."""
    document = copy.deepcopy(document)
    places: list[tuple[Any, Any]] = []
    waiting = [document]
    while waiting:
        entry = waiting.pop()
        if isinstance(entry, dict | list):
            keys = list(entry) if isinstance(entry, dict) else list(range(len(entry)))
            places += [(entry, key) for key in keys]
            waiting += [entry[key] for key in keys]
    if not places:
        return random_.choice(VALUES)
    holder, key = random_.choice(places)
    kind = random_.randrange(6)
    if kind == 0:
        del holder[key]
    elif kind == 1 and isinstance(holder, list):
        holder.insert(key, copy.deepcopy(holder[key]))
    elif kind == 2:
        other, name = random_.choice(places)
        holder[key] = copy.deepcopy(other[name]) if name in other or isinstance(other, list) else 0
    elif kind == 3 and isinstance(holder[key], int | float) and not isinstance(holder[key], bool):
        # Whole numbers in files may be longer than any float.
        half = holder[key] * 0.5 if abs(holder[key]) < LARGE else holder[key] // 2
        holder[key] = random_.choice((holder[key] + 1, -holder[key], holder[key] * 1000, half))
    else:
        holder[key] = copy.deepcopy(random_.choice(VALUES))
    return document


def lines_of_json_changed(data: bytes, random_: random.Random) -> bytes:
    """Change one of the documents, a line each."""
    lines = data.splitlines()
    if not lines:
        return data
    number = random_.randrange(len(lines))
    lines[number] = json_changed(lines[number], random_)
    return b"\n".join(lines) + b"\n"


def glb_changed(data: bytes, random_: random.Random) -> bytes:
    """Change the JSON or the numbers of a GLB file, and leave its frame whole."""
    try:
        size = struct.unpack_from("<I", data, 12)[0]
        document, binary = json.loads(data[20 : 20 + size]), data[28 + size :]
    except (ValueError, RecursionError, struct.error):
        return bytes_changed(data, random_)
    if random_.random() < 0.7:
        document = tree_changed(document, random_)
    else:
        binary = bytes_changed(binary, random_)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = (
        struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def arrays_changed(data: bytes, random_: random.Random) -> bytes:
    """Change the type, the shape or a number of an array, drop one, or rename it."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as held:
            arrays = {name: held[name] for name in held.files}
    except Exception:  # what earlier mutations made of it
        return bytes_changed(data, random_)
    if not arrays:
        return bytes_changed(data, random_)
    name = random_.choice(sorted(arrays))
    array = arrays[name]
    kind = random_.randrange(7)
    if kind == 0:
        del arrays[name]
    elif kind == 1:
        arrays[name + random_.choice("sx")] = arrays.pop(name)
    elif kind == 2:
        with np.errstate(all="ignore"):
            arrays[name] = array.astype(random_.choice(("f4", "i8", "u1", "?", "c16", "U3", "f2", "M8[s]")))
    elif kind == 3:
        arrays[name] = (
            array[..., None] if random_.random() < 0.5 else array[: len(array) // 2] if array.ndim else array
        )
    elif kind == 4:
        arrays[name] = array.reshape(-1)[:0] if random_.random() < 0.5 else np.repeat(array[None], 2, axis=0)
    elif array.size and array.dtype.kind in "fiu":
        flat = array.reshape(-1).copy()
        values = (np.nan, np.inf, 1e300, -1, 0) if array.dtype.kind == "f" else (-1, 0, 255, 1)
        with np.errstate(all="ignore"):
            flat[random_.randrange(len(flat))] = np.array(random_.choice(values)).astype(array.dtype)
        arrays[name] = flat.reshape(array.shape)
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


MUTATIONS: dict[str, tuple[Any, ...]] = {
    ".json": (json_changed, json_changed, json_changed, words_changed, bytes_changed),
    ".toml": (words_changed, words_changed, bytes_changed),
    ".csv": (words_changed, words_changed, bytes_changed),
    ".jsonl": (lines_of_json_changed, lines_of_json_changed, words_changed, bytes_changed),
    ".obj": (words_changed, words_changed, bytes_changed),
    ".ply": (words_changed, bytes_changed, bytes_changed),
    ".glb": (glb_changed, glb_changed, glb_changed, bytes_changed),
    ".vrm": (glb_changed, glb_changed, glb_changed, bytes_changed),
    ".usda": (words_changed, words_changed, bytes_changed),
    ".dxf": (words_changed, words_changed, bytes_changed),
    ".svg": (words_changed, words_changed, bytes_changed),
    ".gltf": (json_changed, json_changed, json_changed, words_changed),
    ".npz": (arrays_changed, arrays_changed, bytes_changed),
    ".vtu": (words_changed, words_changed, bytes_changed),
}
