from dataclasses import replace

import pytest

from toile.dressing.garment.fabrics import (
    DrapeBand,
    checked_fabric,
    drape_bands,
    fabric,
    fabric_table,
    fabrics,
)
from toile.geometry.errors import InputError


def test_presets_are_in_si_units() -> None:
    poplin = fabric("cotton-poplin")
    assert poplin.areal_density == 0.104
    assert poplin.thickness == pytest.approx(0.18e-3)
    assert (poplin.stretch_warp, poplin.stretch_weft, poplin.shear) == (2800.0, 4501.0, 120.0)
    silk = fabric("silk-charmeuse")
    assert (silk.bending_warp, silk.bending_weft, silk.bending_bias) == pytest.approx(
        (1.6e-6, 1.1e-6, 1.2e-6)
    )


def test_bending_is_that_of_the_source_times_a_factor_found_by_drape() -> None:
    poplin = fabric("cotton-poplin")
    bending = (poplin.bending_warp, poplin.bending_weft, poplin.bending_bias)
    assert bending == pytest.approx((1.75 * 5.5e-6, 1.75 * 4.0e-6, 1.75 * 4.5e-6))


def test_every_preset_is_physical_and_in_the_table() -> None:
    assert len(fabrics()) == 10
    table = fabric_table()
    for name, preset in fabrics().items():
        assert checked_fabric(preset) is preset
        assert name in table
        assert 1e-7 < preset.bending_bias < 1e-4


def test_a_drape_band_tells_whether_it_was_measured() -> None:
    bands = drape_bands()
    assert bands["cotton-poplin"] == DrapeBand(60.0, 76.0, estimated=False)
    assert bands["canvas"] == DrapeBand(75.0, 90.0, estimated=True)
    assert "nylon-spandex" not in bands


def test_unknown_name_suggests_the_nearest() -> None:
    with pytest.raises(InputError, match=r"unknown fabric 'denim'; did you mean 'denim-12oz'\?"):
        fabric("denim")
    with pytest.raises(InputError, match="known are: silk-charmeuse, cotton-poplin"):
        fabric("xyzzy")


@pytest.mark.parametrize(
    ("field", "value", "problem"),
    [
        ("stretch_warp", -1.0, "greater than zero"),
        ("areal_density", 0.0, "greater than zero"),
        ("shear", -3.0, "must not be negative"),
        ("friction_self", float("nan"), "finite"),
        ("compression", -0.1, "must not be negative"),
        ("compression", 1.5, "must not exceed 1"),
    ],
)
def test_unphysical_fields_are_named(field: str, value: float, problem: str) -> None:
    with pytest.raises(InputError, match=f"{field}.*{problem}"):
        checked_fabric(replace(fabric("canvas"), **{field: value}))  # type: ignore[arg-type]
