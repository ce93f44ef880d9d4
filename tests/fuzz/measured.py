"""Measurements that users give: valid files, and a garment drafted to them."""

from collections.abc import Iterable
from pathlib import Path

from tests.fuzz.drawn import form
from toile.dressing.body.given_measurements import completed, read_measurements
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.drafts import built_in
from toile.geometry.errors import InputError

TABLE = """
height = 168
chest = 0.96
waist = 80.0
torso_depth = [-0.11, 0.12]
arm_angle = 40

shoulder_point = [17.4, 137, -2.0]
"""
JSON = '{"measurements": {"hip": 1.02, "neck": 36, "wrist": 16.5, "inseam": 76, "armpit_height": 124.5}}'


def measurements() -> Iterable[tuple[str, bytes]]:
    """A few of them in TOML and, as `toile measure` writes them, in JSON."""
    return [(".toml", TABLE.encode()), (".json", JSON.encode())]


def measured_body(path: Path) -> object:
    """Complete measurements of a body that can be measured or not, and draft a garment to them."""
    given = read_measurements(path)
    own = form()
    for measured in (own.measurements, InputError("it sits")):
        pattern = built_in("tshirt", completed(own.avatar, measured, given)[0])
    return mesh_pattern(pattern, edge_length=0.06, curve_edge_length=0.06)
