"""What Blender adds to the work of the engine."""

from pathlib import Path

import pytest

from tests.blender_addon.conftest import Blender


@pytest.mark.slow
def test_blender_adds_less_than_five_percent(blender: Blender, tmp_path: Path) -> None:
    """CPU time of the built-in T-shirt at preview, twice, the first without compiling either."""
    found = blender("overhead.py", tmp_path)
    print(found)
    for engine, blender_s, command in zip(found["engine"], found["blender"], found["command"], strict=True):
        assert blender_s < 0.05 * engine
        assert engine + blender_s < 1.05 * command
