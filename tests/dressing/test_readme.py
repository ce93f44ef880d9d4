"""The code in README.md runs as it stands."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

README = Path(__file__).resolve().parents[2] / "README.md"


def test_python_code_runs(
    fake_drape: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)
    assert len([line for line in code.splitlines() if line.strip()]) <= 10
    drape = fake_drape()
    monkeypatch.chdir(tmp_path)

    exec(code, {})

    assert len(drape.calls) == 1
    assert (tmp_path / "out" / "dressed.glb").is_file()
