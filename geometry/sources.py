"""Source files of toile, and which of them others depend on: what results kept on disk were made from."""

import hashlib
import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("geometry", "collide", "remesh", "engine", "dressing", "studies")
IMPORT = re.compile(rb"^[ \t]*from (toile[\w.]*) import (\([^)]*\)|[^\n#]*)", re.MULTILINE)
HOLDS_KERNELS = re.compile(rb"^from (?:toile\.geometry\.kernel|numba\.extending) import", re.MULTILINE)
CONSTANT = re.compile(r"_*[A-Z][A-Z0-9_]*")
"""Names that kernels may take from modules which hold none: a function would have to be a helper."""


def read_sources() -> dict[str, bytes]:
    """Return the text of every module by its name, `toile.room.module`."""
    found = {}
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            name = ".".join(("toile", *(parts[:-1] if parts[-1] == "__init__" else parts)))
            found[name] = path.read_bytes()
    return found


def kernel_modules(sources: Mapping[str, bytes]) -> set[str]:
    """Return the modules on which machine code depends.

    They are those with kernels, with helpers, and those from which these take constants.
    """
    holders = (name for name, text in sources.items() if HOLDS_KERNELS.search(text))
    return _with_imports(sources, holders, lambda name: CONSTANT.fullmatch(name) is not None)


def modules_behind(sources: Mapping[str, bytes], *modules: str) -> set[str]:
    """Return modules and all that they import of toile, in turn."""
    return _with_imports(sources, modules, lambda name: True)


def hash_of(sources: Mapping[str, bytes], modules: Iterable[str], *more: str) -> str:
    """Return 16 hexadecimal digits that tell these modules' texts, and more words, from others."""
    digest = hashlib.sha256(repr(more).encode())
    for name in sorted(modules):
        digest.update(f"{name} {len(sources[name])} ".encode())
        digest.update(sources[name])
    return digest.hexdigest()[:16]


def _with_imports(
    sources: Mapping[str, bytes], start: Iterable[str], counts: Callable[[str], bool]
) -> set[str]:
    """Return modules with those from which they import a name that counts, or the module itself."""
    found = set(start)
    pending = list(found)
    while pending:
        for home, name in _imports(sources[pending.pop()]):
            inner = f"{home}.{name}"
            module = inner if inner in sources else home
            wanted = module == inner or counts(name)
            if wanted and module in sources and module not in found:
                found.add(module)
                pending.append(module)
    return found


@cache
def _imports(text: bytes) -> list[tuple[str, str]]:
    """Return what a module's text imports of toile, as pairs of a module and a name in it."""
    return [
        (home.decode(), name)
        for home, names in IMPORT.findall(text)
        for name in re.findall(r"(\w+)(?: as \w+)?", re.sub(r"#.*", "", names.decode()))
    ]
