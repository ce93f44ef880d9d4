"""The command `toile fabric fit`."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from toile.dressing.cli.parser import DONE, Commands, Parser, say_progress
from toile.geometry.errors import InputError

if TYPE_CHECKING:
    from toile.dressing.fabric_fit.estimate import Measured
    from toile.engine.cloth.fabric import Fabric

UNITS_HELP = (
    "Values may have units: 42mm, 0.05 gf.cm2/cm, 0.9 gf/(cm.deg), 30 N/m, 12 mN.mm, 5 uN.m, 150 g/m2."
)
DRAPE_EDGE = 0.008
"""Edges of the cloth of a simulated drape test [m]."""


def add_fabric_fit(kinds: "Commands[Parser]") -> None:
    """Add the command that fits a fabric to measurements to the kinds of `toile fabric`."""
    fit = kinds.add_parser(
        "fit",
        help="fit a fabric to measurements",
        description="Fit a fabric to measurements, with uncertainties, as a table of a scene file.",
        epilog=UNITS_HELP,
    )
    fit.add_argument("--kes", type=Path, metavar="FILE", help="KES curves (.csv) or figures (.toml)")
    fit.add_argument("--fast", type=Path, metavar="FILE", help="FAST figures (.toml)")
    fit.add_argument("--u3m", type=Path, metavar="FILE", help="U3M material, or its physics .json")
    fit.add_argument(
        "--cantilever", nargs="+", metavar="LENGTH",
        help="overhang at 41.5 degrees [mm] along warp, weft and perhaps bias (ASTM D1388, BS 3356)",
    )  # fmt: skip
    fit.add_argument(
        "--cusick", metavar="PERCENT", help="drape coefficient (BS 5058): bending by simulated drapes"
    )
    fit.add_argument("--weight", metavar="MASS", help="mass per area [g/m2]")
    fit.add_argument("--thickness", metavar="LENGTH", help="thickness [mm]")
    fit.add_argument("--like", metavar="PRESET", help="preset that supplies what was not measured")
    fit.add_argument("--name", default="measured", help="name of the fabric (default: measured)")
    fit.add_argument("-o", "--output", type=Path, metavar="FILE.toml", help="write the table here")
    fit.add_argument("--picture", type=Path, metavar="FILE.svg", help="picture of the fitted curves")
    fit.set_defaults(run=_run_fit)


def _run_fit(options: argparse.Namespace) -> int:
    """Fit a fabric, print it, and write its table and picture."""
    from toile.dressing.fabric_fit.curve_picture import curves_svg
    from toile.dressing.fabric_fit.estimate import fabric_of, with_bias
    from toile.dressing.fabric_fit.fabric_text import fabric_toml, measured_table
    from toile.dressing.files.writers.atomic import writable_folder, write_atomic
    from toile.dressing.garment.fabrics import fabric

    like = None if options.like is None else fabric(options.like)
    measured = with_bias(_measured(options, like))
    found = fabric_of(measured, options.name, like)
    if options.cusick is not None:
        measured = measured.together(_draped(options, found))
        found = fabric_of(measured, options.name, like)
    print(measured_table(measured, found, options.like))
    for path, content in (
        (options.output, fabric_toml(measured, found).encode()),
        (options.picture, curves_svg(measured.curves, found.name) if measured.curves else None),
    ):
        if path is None:
            continue
        if content is None:
            raise InputError("there is no curve to draw: figures alone were given", field="--picture")
        writable_folder(path.parent)
        write_atomic(path, content)
        print(f"wrote {path}")
    return DONE


def _measured(options: argparse.Namespace, like: "Fabric | None") -> "Measured":
    """Return what all measurements say; those given by hand win."""
    from toile.dressing.fabric_fit.cantilever import DIRECTIONS, cantilever
    from toile.dressing.fabric_fit.estimate import Estimate, Measured
    from toile.dressing.fabric_fit.fast import read_fast
    from toile.dressing.fabric_fit.kes import read_kes
    from toile.dressing.fabric_fit.u3m import read_u3m
    from toile.dressing.fabric_fit.units import quantity

    measured = Measured(values={})
    for path, read in ((options.u3m, read_u3m), (options.fast, read_fast), (options.kes, read_kes)):
        if path is not None:
            measured = measured.together(read(path))
    for said, name, kind, unit in (
        (options.weight, "areal_density", "mass per area", "g/m2"),
        (options.thickness, "thickness", "length", "mm"),
    ):
        if said is not None:
            value = quantity(said, kind, unit)
            own = Estimate(value=value, error=0.01 * value, source="given")
            measured = measured.together(Measured(values={name: own}))
    if options.cantilever is not None:
        density = measured.values.get("areal_density")
        if density is None and like is None:
            raise InputError("--cantilever needs the --weight of the cloth", field="--weight")
        if not 2 <= len(options.cantilever) <= len(DIRECTIONS):
            raise InputError(
                "--cantilever takes overhangs along warp, weft and perhaps bias", field="--cantilever"
            )
        heavy = density.value if density is not None else (0.0 if like is None else like.areal_density)
        lengths = [quantity(said, "length", "mm") for said in options.cantilever]
        measured = measured.together(cantilever(heavy, lengths))
    if not measured.values and options.cusick is None:
        raise InputError("nothing was measured: give --kes, --fast, --u3m, --cantilever or --cusick")
    return measured


def _draped(options: argparse.Namespace, found: "Fabric") -> "Measured":
    """Return the bending that a drape coefficient says."""
    from toile.dressing.fabric_fit.cusick_fit import bending_from_drape
    from toile.dressing.fabric_fit.estimate import Measured
    from toile.dressing.fabric_fit.units import quantity
    from toile.studies.validation.cusick import drape_coefficient, hung

    def percent(material: "Fabric") -> float:
        cloth, _ = hung(material, DRAPE_EDGE)
        return 100.0 * drape_coefficient(cloth)

    wanted = 100.0 * quantity(options.cusick, "strain", "%")
    return Measured(values=bending_from_drape(found, wanted, percent, say_progress))
