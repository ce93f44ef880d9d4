"""A weave from the `yarn` table of a fabric in a scene file."""

from collections.abc import Mapping
from typing import Any

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.weave.woven import Woven, woven
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import is_real

PER_CENTIMETRE = 100.0
NUMBERS = ("ends_per_cm", "picks_per_cm", "warp_wave", "set")
TEXTS = ("warp", "weft", "fibre", "weave")
NEEDED = ("warp", "ends_per_cm", "picks_per_cm")


def read_weave(table: Mapping[str, Any]) -> Woven:
    """Return the weave of a table such as { warp = "cotton:20tex", ends_per_cm = 25, picks_per_cm = 25 }.

    The weft is as the warp where it is not given; `fibre` is that of yarns that name none. Raises InputError.
    """
    for key, value in table.items():
        if key not in NUMBERS + TEXTS:
            raise InputError(unknown_name("key of yarn", key, NUMBERS + TEXTS), field="yarn")
        if not (is_real(value) if key in NUMBERS else isinstance(value, str)):
            raise InputError(
                f"{key} of yarn must be a {'number' if key in NUMBERS else 'text'}", field="yarn"
            )
    missing = [key for key in NEEDED if key not in table]
    if missing:
        raise InputError(f"yarn lacks {', '.join(missing)}", field="yarn")
    fibre = table.get("fibre")
    warp, weft = (_with_fibre(table.get(key, table["warp"]), fibre) for key in ("warp", "weft"))
    try:
        return _of(table, warp, weft)
    except InputError as error:
        raise InputError(f"yarn: {error}", field="yarn") from None


def _of(table: Mapping[str, Any], warp: str, weft: str) -> Woven:
    return woven(
        warp, weft, ends=PER_CENTIMETRE * table["ends_per_cm"], picks=PER_CENTIMETRE * table["picks_per_cm"],
        weave=table.get("weave", "plain"), warp_wave=table.get("warp_wave", 0.5), set=table.get("set", 1.0),
    )  # fmt: skip


def _with_fibre(yarn: str, fibre: str | None) -> str:
    return yarn if fibre is None or ":" in yarn else f"{fibre}:{yarn}"
