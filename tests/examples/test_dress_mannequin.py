"""The example drapes: nothing crosses, and the shirt hangs where a shirt hangs."""

from pathlib import Path

import numpy as np

from examples.dress_mannequin import main


def test_example_drapes_without_crossings(tmp_path: Path) -> None:
    result = main(str(tmp_path), quality="preview")

    assert result.status == "converged"
    assert result.report["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    assert result.report["min_gap_mm"] > 0.0
    written = {path.name for path in tmp_path.iterdir()}
    assert {"dressed.glb", "preview.png", "report.json", "tshirt.ply", "tshirt.obj"} <= written
    (shirt,) = result.garments
    height = float(np.ptp(result.avatar.vertices[:, 1]))
    assert 0.6 * height < shirt.positions[:, 1].mean() < 0.8 * height
