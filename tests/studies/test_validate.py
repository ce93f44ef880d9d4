"""The command that compares the physics with theory: its cheapest cases always, all with `pytest -m slow`."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.cli.main import main
from toile.dressing.garment.fabrics import fabric
from toile.studies.validation.cusick import (
    DISC,
    SPECIMEN,
    drape_coefficient,
    hung,
    ring_mesh,
    specimen,
    tauter,
)
from toile.studies.validation.validate import VALIDATIONS, run_validation
from toile.studies.validation.validate_buckling import buckling_weight, critical_weight
from toile.studies.validation.validate_stick_slip import CRITICAL, critical_friction
from toile.studies.validation.validation_row import (
    absolute_row,
    relative_row,
    stored,
    validation_table,
)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in VALIDATIONS if name != "drape"])
def test_physics_is_right(name: str) -> None:
    rows = list(run_validation([name]))
    assert all(row.met for row in rows), validation_table(rows)


def test_the_command_stores_and_tells_by_its_exit_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "validate.json"
    assert main(["validate", "patch", "curvature", "--json", str(path)]) == 0
    rows = json.loads(path.read_text())
    assert {row["case"] for row in rows} == {"patch", "curvature"}
    assert all(row["met"] and row["error"] <= row["bar"] for row in rows)
    assert {"right", "equilateral", "random"} <= {row["variant"] for row in rows}
    assert "0 beyond their bar" in capsys.readouterr().out


def test_a_missed_bar_fails_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = relative_row("patch", "right", "energy, J", 1.03, 1.0, 2.0)
    monkeypatch.setitem(VALIDATIONS, "patch", lambda: iter([wrong]))
    assert main(["validate", "patch"]) == 1
    assert "MISSED" in capsys.readouterr().out


def test_an_unknown_case_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "bukling"]) == 2
    assert "buckling" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_named_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["validate", "drape", "--json", str(tmp_path / "no" / "such.json")]) == 2
    error = capsys.readouterr().err
    assert "such.json" in error and error.count("\n") == 1


def test_errors_are_shares_or_differences_and_nan_meets_no_bar() -> None:
    assert relative_row("a", "b", "c", 0.98, 1.0, 2.5).error == pytest.approx(2.0)
    row = absolute_row("a", "b", "c", 71.0, 68.0, 2.0)
    assert row.error == pytest.approx(3.0) and not row.met
    broken = absolute_row("a", "b", "c", math.nan, 0.0, 1.0)
    assert not broken.met and stored(broken)["measured"] is None


@pytest.mark.parametrize("poisson", [0.0, 0.3])
def test_a_narrow_strip_on_edge_buckles_under_the_weight_of_the_theory(poisson: float) -> None:
    """What the clamp adds is in proportion to the width: half of it, half the error."""
    exact = critical_weight(poisson)
    assert critical_weight(0.3) == pytest.approx(14.51, abs=0.01)
    wide, narrow = (buckling_weight("right", poisson, width) / exact - 1.0 for width in (0.04, 0.02))
    assert 0.0 < narrow < 0.02
    assert narrow == pytest.approx(0.5 * wide, rel=0.25)


def test_a_strip_pushed_from_below_leans_as_the_elastica_does() -> None:
    assert critical_friction("random", 5.0, 0.2) == pytest.approx(CRITICAL[5.0][0.2], rel=0.003)


def test_tauter_cloth_resists_compression_and_shear_as_before() -> None:
    cloth = fabric("wool-coating")
    taut = tauter(cloth, 20.0)
    assert taut.stretch_warp == pytest.approx(20.0 * cloth.stretch_warp)
    assert taut.compression * taut.stretch_weft == pytest.approx(cloth.compression * cloth.stretch_weft)
    assert taut.shear == cloth.shear


def test_level_cloth_covers_its_ring_and_limp_cloth_hangs() -> None:
    flat, faces = ring_mesh(0.01)
    a, b, c = (flat[faces[:, k]] for k in range(3))
    area = 0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))
    assert area.min() > 0.0
    assert np.linalg.norm(flat, axis=1).max() == pytest.approx(SPECIMEN)
    assert np.isclose(np.linalg.norm(flat, axis=1), DISC).sum() > 40
    assert drape_coefficient(specimen(fabric("silk-charmeuse"), 0.01)) == pytest.approx(1.0, abs=0.01)
    cloth, record = hung(fabric("wool-coating"), 0.012)
    assert record.converged and 0.6 < drape_coefficient(cloth) < 0.8
    assert np.array_equal(cloth.positions[cloth.pinned, 1], np.zeros(cloth.pinned.sum()))
