"""Options that name a weave by its yarns."""

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from toile.dressing.weave.woven import Woven


def add_weave_options(command: argparse.ArgumentParser) -> None:
    """Add the options of a weave."""
    command.add_argument(
        "--yarn", required=True, metavar="FIBRE:COUNT",
        help="warp yarn, such as cotton:20tex; counts in tex, dtex, den, Ne or Nm",
    )  # fmt: skip
    command.add_argument("--weft", metavar="FIBRE:COUNT", help="weft yarn (default: as the warp)")
    command.add_argument("--ends", type=float, required=True, metavar="N", help="warp yarns per centimetre")
    command.add_argument("--picks", type=float, required=True, metavar="N", help="weft yarns per centimetre")
    command.add_argument(
        "--weave", default="plain", help="plain, twill, satin, or A/B, such as 3/1 (default: plain)"
    )
    command.add_argument(
        "--warp-wave", type=float, default=0.5, metavar="SHARE",
        help="share of the waves that is the warp's (default: 0.5)",
    )  # fmt: skip


def weave_of(options: argparse.Namespace) -> "Woven":
    """Return the weave of the options. Raises InputError."""
    from toile.dressing.weave.woven import woven

    return woven(
        options.yarn, options.weft or options.yarn, ends=100.0 * options.ends, picks=100.0 * options.picks,
        weave=options.weave, warp_wave=options.warp_wave,
    )  # fmt: skip
