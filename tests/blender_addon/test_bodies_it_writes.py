"""Bodies that Blender exports come back as Blender shows them, in every format and with many options."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from tests.blender_addon.conftest import Blender
from tests.dressing.files.test_round_trip import assert_comes_back

FEWEST = 45
POSED = 5e-6
"""Tolerance of glTF relative to the size: bones are multiplied in single precision."""


def test_what_blender_writes(
    blender: Blender, tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    found = blender("write_bodies.py", tmp_path)
    z_up = np.array(found["triangles"])
    turned = {"z_up": z_up, "y_up": np.stack([z_up[:, :, 0], z_up[:, :, 2], -z_up[:, :, 1]], axis=2)}
    wrong = []
    for place, triangles in turned.items():
        for name, options in found[place]:
            try:
                assert_comes_back(tmp_path / name, triangles, POSED)
            except AssertionError as error:
                wrong.append(f"{name} {options}: {error}")
    record_property("combinations", len(found["z_up"]) + len(found["y_up"]))
    assert wrong == []
    assert len(found["z_up"]) + len(found["y_up"]) >= FEWEST
