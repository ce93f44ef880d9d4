"""A woven fabric in words and numbers, and as the table of a scene file."""

import math

from toile.dressing.weave.woven import TENSIONS, Woven

HONEST = (
    "Nothing is fitted. Typical counts give the areal density of measured cloth within a fifth, stretch and\n"
    "shear in the right order. Bending is a lower bound, that of fibres that slide freely: measured worsted\n"
    "and silk are as stiff, poplin four, denim six, canvas nine times."
)
CURVE = (10.0, 50.0, 100.0, 500.0)
"""Tensions at which strains are printed [N/m]."""


def weave_lines(cloth: Woven) -> list[str]:
    """Return what is known of a fabric, one line each."""
    lines = [
        f"areal density  {cloth.areal_density * 1e3:7.1f} g/m2",
        f"thickness      {cloth.thickness * 1e3:7.3f} mm",
        f"shear          {cloth.shear:7.1f} N/m at first",
        f"yarns touch at {math.degrees(cloth.locking):7.1f} degrees of shear",
        "                  warp     weft",
    ]
    both = (cloth.warp, cloth.weft)
    rows: tuple[tuple[str, str, list[float]], ...] = (
        ("crimp", "%", [100.0 * one.crimp for one in both]),
        ("stretch at first", "N/m", [one.stiffness for one in both]),
        ("bending", "uN m", [1e6 * one.bending for one in both]),
        ("contraction", "", [one.contraction for one in both]),
    )
    for name, unit, values in rows:
        lines.append(f"{name:<17}{values[0]:9.3g}{values[1]:9.3g} {unit}".rstrip())
    for tension in CURVE:
        at = TENSIONS.index(tension)
        strains = [100.0 * one.curve[at].strain[axis] for axis, one in enumerate(both)]
        lines.append(f"{f'at {tension:g} N/m':<17}{strains[0]:9.3g}{strains[1]:9.3g} %")
    return [*lines, "", HONEST]


def weave_table(cloth: Woven, name: str) -> str:
    """Return the fabric as a table of a scene file, with its curves."""
    fabric = cloth.fabric(name)
    lines = [f"[fabric.{name}]"]
    for key in (
        "areal_density", "thickness", "bending_warp", "bending_weft", "bending_bias", "stretch_warp",
        "stretch_weft", "shear", "poisson",
    ):  # fmt: skip
        lines.append(f"{key} = {getattr(fabric, key):.6g}")
    for key in ("stretch_curve_warp", "stretch_curve_weft"):
        points = ", ".join(f"[{strain:.6g}, {tension:g}]" for strain, tension in getattr(fabric, key))
        lines.append(f"{key} = [{points}]")
    return "\n".join(lines) + "\n"
