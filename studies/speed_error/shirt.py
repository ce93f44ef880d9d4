"""`shirt`: the built-in T-shirt on the mannequin, over meshes, presets and tolerances.

A shirt has many equilibria, and which one its folds reach is chaotic: two meshes of nearly the same edges end
as far apart as coarse and fine ones. So there are two charts: distance from the finest mesh, with the
distance between two like meshes as its floor, and distance from the equilibrium of the same mesh.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.mannequin import mannequin
from toile.dressing.garment.fabrics import DEFAULT_FABRIC, fabric
from toile.dressing.pattern.sewing_edges import SewingEdges, sewing_edges
from toile.dressing.run.load_garment import load_garment
from toile.dressing.run.quality import QUALITIES, Quality
from toile.dressing.run.resolved_scene import resolve
from toile.dressing.run.scene import Garment, Scene
from toile.dressing.wear.drape_types import DrapeOptions, FrameState
from toile.dressing.wear.put_on import drape
from toile.geometry.arrays import Float, Int
from toile.studies.adaptive.surface_distance import mean_surface_distance
from toile.studies.scenes.run import load_all_kernels
from toile.studies.speed_error.point import Chart, Effort, Point
from toile.studies.speed_error.timed import timed

AT_REST, PATIENCE = 3e-5, 1000
"""Motion over a frame at which references rest [m], and frames at most."""
STANDARD = QUALITIES["standard"]
EDGES = (0.030, 0.020, 0.014, 0.010)
"""Of uniform meshes [m]."""
ANGLES = (0.8, 0.3)
"""Of adaptive meshes of the finest edges of `standard` [rad]."""
TOLERANCES = (2e-3, 1e-3, 4e-4, 2e-4, 1e-4)
NUDGE = 1.02
"""Factor on the edges of a mesh that should end where the reference does, but for chaos."""


class Way(NamedTuple):
    """A way to dress: curve and label of its point, finest edges [m], and what else a quality says."""

    curve: str
    label: str
    edge: float
    adaptive: bool
    angle: float = STANDARD.refine_angle
    tolerance: float = STANDARD.tolerance
    max_frames: int = STANDARD.max_frames
    self_contact: bool = True


@dataclass(frozen=True)
class Dressed:
    """A draped shirt: nodes [m], shape (n, 3), faces, shape (t, 3), and figures of the drape."""

    positions: Float
    faces: Int
    mean_faces: float
    crossings: int
    frames: int

    def distance(self, other: "Dressed") -> float:
        """Return the mean distance of the surface from another [mm]."""
        return 1e3 * mean_surface_distance((self.positions, self.faces), (other.positions, other.faces))


class Fitting:
    """The mannequin, drafted for once."""

    def __init__(self) -> None:
        self._avatar = mannequin()
        self._form = DressForm(self._avatar)
        (self._shirt,) = resolve(Scene(garments=[Garment("tshirt")])).garments

    def dressed(self, way: Way) -> Dressed:
        """Mesh, sew and drape the shirt as `toile.dress` does."""
        quality = Quality(
            name=way.label, edge_length=way.edge, max_frames=way.max_frames, refine_angle=way.angle,
            tolerance=way.tolerance,
        )  # fmt: skip
        sizing = quality.sizing(way.edge) if way.adaptive else None
        sewn = SewingEdges(way.edge, way.edge)
        if sizing is not None:
            sewn = sewing_edges(way.edge, sizing.size_max)[0]
        mesh = load_garment(self._shirt, self._form, sewn)
        options = DrapeOptions(
            edge_length=sewn.length, max_frames=quality.max_frames, tolerance=quality.tolerance,
            sizing=sizing, self_contact=(way.self_contact,),
        )  # fmt: skip
        faces = []

        def count(state: FrameState) -> bool:
            faces.append(state.faces)
            return True

        outcome = drape(DressForm(self._avatar), [(mesh, fabric(DEFAULT_FABRIC))], options, count)
        garment = outcome.garments[0]
        return Dressed(
            garment.positions, garment.faces, float(np.mean(faces)),
            outcome.figures.worst_frame_intersections, outcome.figures.frames,
        )  # fmt: skip

    def points(self, effort: Effort, ways: Sequence[Way], reference: Dressed) -> tuple[Point, ...]:
        """Dress in all ways and compare with the reference."""
        return tuple(self._point(effort, way, reference) for way in ways)

    def _point(self, effort: Effort, way: Way, reference: Dressed) -> Point:
        done, timing = timed(lambda: self.dressed(way), effort.repeats)
        error = done.distance(reference)
        effort.say(
            f"shirt, {way.curve}, {way.label}: {error:.3g} mm, {timing.cpu:.1f} CPU s, "
            f"{done.crossings} crossings"
        )
        return Point(
            curve=way.curve, label=way.label, cpu=timing.cpu, spread=timing.spread, repeats=timing.repeats,
            error=error, faces=done.mean_faces, crossings=done.crossings,
            preset=way.label if way.label in QUALITIES else "", figures={"frames": done.frames},
        )  # fmt: skip


def study_shirt(effort: Effort) -> Iterator[Chart]:
    """Measure meshes and presets, then how nearly the shirt comes to rest."""
    load_all_kernels()
    fitting = Fitting()
    yield _meshes(effort, fitting)
    yield _rest(effort, fitting)


def presets(curve: str, names: Sequence[str]) -> list[Way]:
    """Return the quality presets as ways."""
    return [
        Way(
            curve, quality.name, quality.edge_length, True, quality.refine_angle, quality.tolerance,
            quality.max_frames,
        )
        for quality in (QUALITIES[name] for name in names)
    ]  # fmt: skip


def _meshes(effort: Effort, fitting: Fitting) -> Chart:
    """Distance from a fine mesh."""
    edge = 0.014 if effort.quick else 0.008
    reference = fitting.dressed(_at_rest(edge))
    chance = fitting.dressed(_at_rest(NUDGE * edge))
    floor = chance.distance(reference)
    effort.say(f"shirt: reference is done; edges 2 % longer end {floor:.3g} mm from it")
    uniform = [
        Way("uniform meshes", f"{1e3 * edge:g} mm", edge, False)
        for edge in (EDGES[:2] if effort.quick else EDGES)
    ]
    if effort.quick:
        ways = [*uniform, *presets("presets", ("preview", "standard"))]
    else:
        adaptive = [
            Way("adaptive meshes of 10 mm", f"{angle:g} rad", STANDARD.edge_length, True, angle)
            for angle in ANGLES
        ]
        contact = Way("contact left out", "no self-contact", STANDARD.edge_length, True, self_contact=False)
        ways = [*uniform, *adaptive, *presets("presets", tuple(QUALITIES)), contact]
    return Chart(
        scene="shirt",
        title="meshes and presets",
        error="mean distance of the surface at the end",
        unit="mm",
        reference=f"uniform edges of {1e3 * edge:g} mm, at rest to {1e3 * AT_REST:g} mm per frame; the floor "
        f"is how far a mesh of edges {100 * (NUDGE - 1):.0f} % longer ends from it",
        floor=floor,
        points=fitting.points(effort, ways, reference),
    )


def _rest(effort: Effort, fitting: Fitting) -> Chart:
    """Distance from the place of rest of the same mesh."""
    edge = 0.020 if effort.quick else 0.014
    reference = fitting.dressed(_at_rest(edge))
    less = fitting.dressed(_at_rest(edge, factor=4.0))
    tolerances = TOLERANCES[1:3] if effort.quick else TOLERANCES
    ways = [
        Way("tolerance", f"{1e3 * tolerance:g} mm", edge, False, tolerance=tolerance, max_frames=PATIENCE)
        for tolerance in tolerances
    ]
    return Chart(
        scene="shirt",
        title=f"how nearly it rests, uniform edges of {1e3 * edge:g} mm",
        error="mean distance of the surface from the same mesh at rest",
        unit="mm",
        reference=f"the same mesh, at rest to {1e3 * AT_REST:g} mm per frame; the floor is how far 4 times "
        "that ends from it",
        floor=less.distance(reference),
        points=fitting.points(effort, ways, reference),
    )


def _at_rest(edge: float, factor: float = 1.0) -> Way:
    """Return the way of references: uniform edges [m], drape until little moves."""
    return Way("reference", "", edge, False, tolerance=factor * AT_REST, max_frames=PATIENCE)
