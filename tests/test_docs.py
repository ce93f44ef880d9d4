"""The documents: form of decision records, links, a short glossary, tables that name every module."""

import re
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).resolve().parents[1]
DECISIONS = ROOT / "docs" / "decisions"
INDEX = DECISIONS / "README.md"
RECORDS = sorted(path for path in DECISIONS.glob("*.md") if path != INDEX)
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "bench").rglob("*.md")),
]
MOST_GLOSSARY_ENTRIES = 40
PACKAGES = ("geometry", "collide", "remesh", "engine", "dressing", "studies", "blender_addon")
HEADINGS = ["Context", "Options", "Decision"]
DATE_LINE = re.compile(
    r"Date: \d{4}-\d\d-\d\d · Commit: [0-9a-f]{7} · "
    r"Status: (accepted|rejected|superseded by \[(\d{4})\]\(\2-[a-z0-9-]+\.md\))"
)
ROW = re.compile(r"^\| \[(\d{4})\]\((\S+)\) \| (.+?) \| (\S+) \| (.+?) \| \S.* \|$", re.M)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def without_code(page: str) -> str:
    """Drop fenced blocks and inline code: what looks like a link or heading there is none."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```", "", page, flags=re.M | re.S))


def anchors(page: str) -> set[str]:
    """Anchors that GitHub gives to the headings of a page."""
    seen: dict[str, int] = {}
    found = set()
    for heading in re.findall(r"^#+ +(.*)$", re.sub(r"^```.*?^```", "", page, flags=re.M | re.S), re.M):
        slug = re.sub(r"[^\w\- ]", "", re.sub(r"\]\([^)]*\)", "]", heading).lower()).strip().replace(" ", "-")
        found.add(slug if slug not in seen else f"{slug}-{seen[slug]}")
        seen[slug] = seen.get(slug, 0) + 1
    return found


def broken_links(path: Path) -> list[str]:
    """Relative links of a page whose file or anchor does not exist."""
    broken = []
    for link in LINK.findall(without_code(path.read_text(encoding="utf-8"))):
        if re.match(r"[a-z]+:", link):
            continue
        file, _, anchor = unquote(link).partition("#")
        target = path.parent / file if file else path
        if not target.exists() or (
            anchor and target.suffix == ".md" and anchor not in anchors(target.read_text(encoding="utf-8"))
        ):
            broken.append(link)
    return broken


@pytest.mark.parametrize("path", RECORDS, ids=lambda path: path.stem)
def test_record_has_title_date_line_and_headings(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    assert re.fullmatch(rf"# {int(path.stem[:4])}\. \S.*", lines[0])
    assert DATE_LINE.fullmatch(lines[2]), lines[2]
    headings = [line[3:] for line in lines if line.startswith("## ")]
    assert headings in (HEADINGS, [*HEADINGS, "Consequences"])
    for heading, following in zip(headings, [*headings[1:], None], strict=True):
        start = lines.index(f"## {heading}") + 1
        end = len(lines) if following is None else lines.index(f"## {following}")
        assert any(lines[start:end]), f"nothing under {heading}"


def test_numbers_of_records_are_consecutive() -> None:
    assert [path.stem[:5] for path in RECORDS] == [f"{k:04d}-" for k in range(1, len(RECORDS) + 1)]


def test_index_lists_every_record_as_it_stands() -> None:
    rows = ROW.findall(INDEX.read_text(encoding="utf-8"))
    assert sorted(name for _, name, *_ in rows) == [path.name for path in RECORDS]
    for number, name, title, date, status in rows:
        lines = (DECISIONS / name).read_text(encoding="utf-8").splitlines()
        assert lines[0] == f"# {int(number)}. {title}"
        assert lines[2].startswith(f"Date: {date} · ")
        assert lines[2].endswith(f" · Status: {status}")


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_relative_links_lead_somewhere(path: Path) -> None:
    assert broken_links(path) == []


def test_broken_links_are_found(tmp_path: Path) -> None:
    (tmp_path / "other.md").write_text("# One two\n\n## `three`, four\n\n# One two\n")
    page = tmp_path / "page.md"
    page.write_text(
        "[a](other.md) [b](other.md#one-two) [c](other.md#one-two-1) [d](other.md#three-four) [e](#here) "
        "[f](https://example.org/none) `[g](none.md)`\n\n## Here\n\n"
        "[h](other.md#one) [i](none.md) ![j](none.png) [k\nl](gone.md) [m](#there)\n"
    )
    assert broken_links(page) == ["other.md#one", "none.md", "none.png", "gone.md", "#there"]


def test_glossary_is_short_and_defines_each_word_once() -> None:
    words = re.findall(r"^- \*\*(.+?)\*\*: \S", (ROOT / "docs" / "glossary.md").read_text("utf-8"), re.M)
    assert 0 < len(words) <= MOST_GLOSSARY_ENTRIES
    assert len({word.lower() for word in words}) == len(words)


def modules() -> list[str]:
    """Paths of the modules of all packages."""
    found = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
    return sorted(path.relative_to(ROOT).as_posix() for path in found if path.name != "__init__.py")


def modules_named(page: str) -> list[str]:
    """Modules in the first column of the table under each heading that names a folder of the packages."""
    named = []
    for section in re.split(r"^### ", page, flags=re.M)[1:]:
        room, _, text = section.partition("\n")
        if room.partition("/")[0] in PACKAGES:
            rows = re.findall(r"^\| ([^|]*\.py`[^|]*) \|", text, re.M)
            named += [f"{room}/{name}" for name in re.findall(r"`([^`]+)`", " ".join(rows))]
    return sorted(named)


def test_tables_of_the_architecture_name_every_module_in_its_room() -> None:
    named, there = modules_named((ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")), modules()
    assert sorted(set(there) - set(named)) == [], "modules that no table names"
    assert sorted(set(named) - set(there)) == [], "named where they are not"
    assert len(named) == len(there)


def test_modules_are_found_in_the_table_of_their_room() -> None:
    page = (
        "### engine/step\n\nSee `other.py`.\n\n| file | holds |\n|---|---|\n"
        "| `a.py`, `b.py` | with `c.py` |\n"
        "### Other\n\n| `d.py` | |\n\n### engine\n\n| `a.py` | |\n"
    )
    assert modules_named(page) == ["engine/a.py", "engine/step/a.py", "engine/step/b.py"]


def test_paths_in_documents_exist() -> None:
    """A path in code font that begins with a package leads to a file or folder."""
    place = re.compile(rf"`((?:{'|'.join(PACKAGES)})/[\w/.-]+)`")
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
    named = [(path.name, name) for path in pages for name in place.findall(path.read_text(encoding="utf-8"))]
    assert [(page, name) for page, name in named if not (ROOT / name).exists()] == []
