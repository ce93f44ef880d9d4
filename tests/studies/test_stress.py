"""The hard cases: all with `pytest -m stress`, the cheapest always."""

import json
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.cli.main import main
from toile.dressing.run.dress import dress
from toile.dressing.run.scene import AvatarFile, Garment, Scene
from toile.studies.stress.stress import STRESS_CASES, run_case
from toile.studies.stress.stress_row import stress_table


@pytest.mark.stress
@pytest.mark.parametrize("remesh", [False, True])
@pytest.mark.parametrize("name", STRESS_CASES)
def test_hard_case(name: str, remesh: bool) -> None:
    row = run_case(name, remesh)
    assert not row.fell_short, stress_table([row])


@pytest.mark.stress
@pytest.mark.parametrize("garment", ["tshirt", "circle_skirt"])
def test_a_walking_body_takes_its_garment_along(garment: str, data_dir: Path) -> None:
    walk = data_dir / "bodies" / "anim_f_apose_to_walk.npz"
    scene = Scene(garments=[Garment(garment)], avatar=AvatarFile(path=walk), quality="preview", remesh=False)
    result = dress(scene)
    animation = result.report["animation"]
    assert result.status in ("converged", "frame_limit"), result.report["failure"]
    assert animation["frames"] == 59 and animation["intersections_max"] == 0
    assert np.isfinite(result.garments[0].positions).all()


def test_the_command_stores_draws_and_tells_by_its_exit_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stored, drawn = tmp_path / "stress.json", tmp_path / "pictures"
    assert main(["stress", "stiff_canvas", "--json", str(stored), "--pictures", str(drawn)]) == 0
    rows = json.loads(stored.read_text())
    assert [row["remesh"] for row in rows] == [False, True]
    assert all(row["outcome"] == "valid" and row["intersections"] == 0 for row in rows)
    assert {path.name for path in drawn.iterdir()} == {"stiff_canvas.png", "stiff_canvas_remesh.png"}
    assert "stiff_canvas" in capsys.readouterr().out


def test_an_unknown_case_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stress", "stif_canvas"]) == 2
    assert "stiff_canvas" in capsys.readouterr().err
