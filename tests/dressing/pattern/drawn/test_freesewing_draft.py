"""FreeSewing designs drafted by Node: what is missing is said in one line."""

import stat
from pathlib import Path

import pytest

from toile.dressing.pattern.drawn.freesewing_draft import draft_freesewing
from toile.geometry.errors import InputError


def node_that(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    node = tmp_path / "node"
    node.write_text(f"#!/bin/sh\n{script}\n")
    node.chmod(node.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")


def test_without_node_the_message_says_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match=r"needs Node\.js 20 or later, which is not installed"):
        draft_freesewing("teagan", {}, tmp_path)


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("echo @freesewing/teagan >&2; exit 3", "package @freesewing/teagan is missing.*npm install"),
        ("echo chest, neck >&2; exit 4", "needs the measurements chest, neck"),
        ("echo Error: bad >&2; exit 1", "drafting teagan failed: Error: bad"),
        ("echo nothing", "it returned no drawing"),
    ],
)
def test_what_node_misses_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str, said: str
) -> None:
    node_that(tmp_path, monkeypatch, script)
    with pytest.raises(InputError, match=said) as raised:
        draft_freesewing("teagan", {"chest": 900.0}, tmp_path)
    assert "\n" not in str(raised.value)


def test_the_date_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    node_that(tmp_path, monkeypatch, "echo '<svg><text>Monday, Nov 30, 2026</text></svg>'")
    assert draft_freesewing("teagan", {}, tmp_path).strip() == "<svg><text></text></svg>"


def test_names_of_designs_are_checked(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no FreeSewing design"):
        draft_freesewing("../x", {}, tmp_path)
