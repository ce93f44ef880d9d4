"""Measurements of tailors: against tables of real bodies, against solids, and under their other names."""

import json
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.body.avatar import load_avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.body.tailoring.names import FREESEWING, GARMENTCODE, SEAMLY
from toile.dressing.body.tailoring.tailor_measurements import TailorMeasurements, tailor_measurements
from toile.dressing.body.write_body import body_bytes
from toile.dressing.cli.main import main


@pytest.fixture(scope="module")
def found() -> TailorMeasurements:
    body = mannequin()
    return tailor_measurements(body, measure(body))


def test_lengths_over_the_surface_are_longer_than_the_way_down(found: TailorMeasurements) -> None:
    measured = measure(mannequin())
    down = measured.neck_height - measured.waist_height
    assert down < found.neck_to_waist_back < 1.25 * down
    assert measured.neck_height - measured.chest_height < found.neck_to_bust < found.neck_to_waist_front
    rise = measured.waist_height - measured.crotch_height
    assert 2.0 * rise < found.crotch_seam < 2.0 * rise + np.pi * 0.15
    assert 0.35 * found.crotch_seam < found.crotch_seam_front < 0.5 * found.crotch_seam


def test_arcs_and_levels_lie_where_they_must(found: TailorMeasurements) -> None:
    measured = measure(mannequin())
    for arc, girth in (("chest_back", "chest"), ("waist_back", "waist"), ("hip_back", "hip")):
        assert 0.4 * getattr(measured, girth) < getattr(found, arc) < 0.6 * getattr(measured, girth)
    assert measured.waist < found.hip_bone < measured.hip
    assert measured.waist < found.underbust < measured.chest
    assert found.ankle_height < found.knee_height < measured.crotch_height < found.hip_bone_height
    assert found.ankle < found.knee < measured.thigh
    assert 1.25 * found.ankle < found.heel < 2.0 * found.ankle
    assert 0.5 < found.head < 0.62
    assert 10.0 < np.degrees(found.shoulder_slope) < 35.0


@pytest.mark.parametrize("name", ["mean_all.obj", "mean_female.ply", "mean_male.ply"])
def test_real_bodies_measure_as_their_tables_say(data_dir: Path, name: str) -> None:
    yaml = pytest.importorskip("yaml")
    path = data_dir / "bodies" / name
    known = yaml.safe_load(path.with_suffix(".yaml").read_text())["body"]
    body = load_avatar(path)
    measured = measure(body)
    ours = tailor_measurements(body, measured)
    assert 100.0 * ours.neck_to_bust == pytest.approx(known["bust_line"], abs=1.5)
    assert 100.0 * ours.underbust == pytest.approx(known["underbust"], abs=0.9)
    assert 100.0 * (measured.neck_height - measured.chest_height) == pytest.approx(
        known["vert_bust_line"], abs=1.5
    )
    # Means of surveys are 31 cm (women) and 34 cm (men).
    assert 0.295 < ours.heel < 0.355
    assert np.degrees(ours.shoulder_slope) == pytest.approx(known["shoulder_incl"], abs=1.5)


def test_json_has_all_fields_and_the_names_of_other_programs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "body.obj"
    path.write_bytes(body_bytes(mannequin(), ".obj"))
    assert main(["measure", str(path), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    measured = measure(load_avatar(path))
    assert set(said["measurements"]) == set(vars(measured))
    assert set(said["more"]) == set(TailorMeasurements.__dataclass_fields__)
    assert said["measurements"]["chest"] == pytest.approx(100.0 * measured.chest, abs=0.01)
    for system, names in (("freesewing", FREESEWING), ("garmentcode", GARMENTCODE), ("seamly", SEAMLY)):
        assert set(said["names"][system]) == {"units", *names}
    assert said["names"]["freesewing"]["seat"] == pytest.approx(1000.0 * measured.hip, abs=0.01)
    assert said["names"]["garmentcode"]["arm_pose_angle"] == pytest.approx(
        np.degrees(measured.arm_angle), abs=0.01
    )
    # What it prints can be given back.
    (tmp_path / "m.json").write_text(json.dumps(said))
    command = ["patterns", "--write", str(tmp_path), "--avatar", str(path)]
    assert main([*command, "--measurements", str(tmp_path / "m.json")]) == 0
