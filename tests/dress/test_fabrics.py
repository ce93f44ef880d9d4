from dataclasses import replace

import pytest

from toile.dress.fabrics import checked_fabric, fabric, fabric_table, fabrics
from toile.geometry.errors import InputError


def test_presets_are_in_si_units() -> None:
    poplin = fabric("cotton-poplin")
    assert poplin.areal_density == 0.104
    assert poplin.thickness == pytest.approx(0.18e-3)
    assert (poplin.stretch_warp, poplin.stretch_weft, poplin.shear) == (2800.0, 4501.0, 120.0)
    assert poplin.bending_warp == pytest.approx(5.5e-6)
    assert poplin.bending_weft == pytest.approx(4.0e-6)
    assert poplin.bending_bias == pytest.approx(4.5e-6)


def test_every_preset_is_physical_and_in_the_table() -> None:
    assert len(fabrics()) == 10
    table = fabric_table()
    for name, preset in fabrics().items():
        assert checked_fabric(preset) is preset
        assert name in table
        assert 1e-7 < preset.bending_bias < 1e-4


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
