"""The experiments by their names."""

from collections.abc import Callable

from toile.dressing.swatch.bias_extension import pull_on_bias
from toile.dressing.swatch.cantilever import bend_cantilever
from toile.dressing.swatch.curve import Curve
from toile.dressing.swatch.pull_out import pull_yarn_out
from toile.dressing.swatch.sag import let_sag
from toile.dressing.swatch.shear_frame import shear_in_frame
from toile.dressing.swatch.snag import snag
from toile.dressing.swatch.uniaxial import pull_uniaxially

EXPERIMENTS: dict[str, Callable[..., Curve]] = {
    "uniaxial": pull_uniaxially, "bias": pull_on_bias, "shear": shear_in_frame, "bend": bend_cantilever,
    "pull-out": pull_yarn_out, "sag": let_sag, "snag": snag,
}  # fmt: skip
RUBBED = ("uniaxial", "bias", "pull-out", "snag")
"""Experiments in which yarns may slide against friction."""
