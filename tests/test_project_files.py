"""Files about the project: they parse, and they agree on versions."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
YAML_FILES = ("CITATION.cff", ".pre-commit-config.yaml", ".github/workflows/ci.yml")


def parsed(name: str) -> dict[Any, Any]:
    """A YAML file of the checkout."""
    yaml = pytest.importorskip("yaml", reason="PyYAML is not installed")
    content = yaml.safe_load((ROOT / name).read_text(encoding="utf-8"))
    assert isinstance(content, dict)
    return content


def test_versions_agree() -> None:
    version = PROJECT["version"]
    cited = re.search(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    assert cited is not None and cited.group(1) == version
    changes = re.findall(r"^## \[(.*?)\]", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert changes[0] == version
    assert changes == sorted(changes, key=lambda text: [int(part) for part in text.split(".")], reverse=True)


@pytest.mark.parametrize("name", YAML_FILES)
def test_yaml_parses(name: str) -> None:
    assert parsed(name)


def test_citation_has_what_the_format_requires() -> None:
    citation = parsed("CITATION.cff")
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(citation)
    assert citation["authors"] == [{"name": "toile maintainers"}]


def test_ci_covers_the_declared_pythons_and_numpys() -> None:
    matrix = parsed(".github/workflows/ci.yml")["jobs"]["unit-tests"]["strategy"]["matrix"]
    assert ">=" + matrix["python"][0] == PROJECT["requires-python"]
    oldest = re.search(r"numpy>=([\d.]+)", " ".join(PROJECT["dependencies"]))
    assert oldest is not None and matrix["numpy"][0] == f"{oldest.group(1)}.*"
    assert matrix["exclude"] == [{"python": "3.13", "numpy": "1.26.*"}]
    steps = parsed(".github/workflows/ci.yml")["jobs"]["unit-tests"]["steps"]
    folders = re.findall(r"tests/[\w/.]+", steps[-1]["run"])
    assert folders and all((ROOT / folder).exists() for folder in folders)


def test_hooks_run_a_ruff_that_the_project_accepts() -> None:
    hooks = {entry["repo"].rpartition("/")[2]: entry for entry in parsed(".pre-commit-config.yaml")["repos"]}
    pinned = [int(part) for part in hooks["ruff-pre-commit"]["rev"].removeprefix("v").split(".")]
    (wanted,) = (entry for entry in PROJECT["optional-dependencies"]["dev"] if entry.startswith("ruff"))
    assert pinned >= [int(part) for part in wanted.removeprefix("ruff>=").split(".")]
