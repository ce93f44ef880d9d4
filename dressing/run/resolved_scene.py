"""A scene with every choice made: presets looked up, names found, defaults filled in."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.given_measurements import NAMES, Given
from toile.dressing.body.measurements import Measurements
from toile.dressing.body.obstacles.obstacle import Obstacle
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.fabrics import checked_fabric, fabrics
from toile.dressing.garment.fields.field import Parts
from toile.dressing.pattern.pattern import Fold
from toile.dressing.pattern.sewing_edges import SewingEdges, sewing_edges
from toile.dressing.run.garment_source import GarmentSource, checked_source, default_name
from toile.dressing.run.quality import Quality, quality_preset
from toile.dressing.run.result import file_stem
from toile.dressing.run.scene import OFF, AvatarFile, AvatarSource, Garment, MannequinSize, Scene
from toile.engine.cloth.fabric import Fabric
from toile.engine.forces.air_flow import AirFlow
from toile.geometry.errors import InputError, about
from toile.remesh.sizing.sizing import SizingOptions

SEWING_FINENESS = 1.0, 0.92
"""Edge length in which a garment is sewn whose mesh stays, in edges as asked for; the next if seams jam."""


@dataclass(frozen=True, kw_only=True)
class ResolvedGarment:
    """One garment of a scene.

    Attributes
    ----------
    name
        Name in output files, which no other garment of the scene has.
    source
        What it is made from.
    fabric
        Its fabric, checked.
    self_contact, pins, warp_angle, units, up, walls, size, allowance
        As in `Garment`.
    seams
        A seams file, seams as texts, or None.
    panel_fabrics
        Fabric of panels that are of another, checked, by their names.
    folds
        Folds of panels, by their names.
    parts
        Fields, elastic, holds and gas.
    """

    name: str
    source: GarmentSource
    fabric: Fabric
    self_contact: bool
    pins: tuple[str | int, ...]
    warp_angle: float | Mapping[str, float]
    units: str | None
    up: str | None
    walls: int
    size: str | None = None
    allowance: float | None = None
    seams: Path | tuple[str, ...] | None = None
    panel_fabrics: Mapping[str, Fabric] = field(default_factory=dict)
    folds: Mapping[str, Sequence[Fold]] = field(default_factory=dict)
    parts: Parts = field(default_factory=Parts)


@dataclass(frozen=True, kw_only=True)
class ResolvedScene:
    """The input of a run; `resolve` has checked everything that can be checked without reading files.

    Attributes
    ----------
    garments
        From the body outwards.
    avatar
        The body, or where it comes from.
    measurements
        Those of the body that are given, in metres and radians, or the file that holds them.
    quality
        Name of the quality.
    tolerance
        Residual below which the drape is converged [m].
    max_frames
        Frames after which it stops.
    edge_length
        Edge length of the triangles, of the finest where the mesh adapts and `sizing` has not another [m].
    sizing
        How the mesh adapts, or None.
    sewing
        Edges in which the garments are sewn, one after the other until seams close.
    gravity
        Downward acceleration [m/s^2].
    friction
        Coulomb coefficient against the avatar for all garments, or None for each fabric's own.
    friction_between
        Coefficients of pairs of fabrics that are worn, or of one and "body", by their names.
    air
        Air around garments that follow a body in motion, or None.
    formats, ground, fit, certificate, obstacles
        As in `Scene`.
    """

    garments: tuple[ResolvedGarment, ...]
    avatar: AvatarSource
    measurements: Given | Path
    quality: str
    tolerance: float
    max_frames: int
    edge_length: float
    sizing: SizingOptions | None
    sewing: tuple[SewingEdges, ...]
    gravity: float
    friction: float | None
    friction_between: Mapping[frozenset[str], float]
    air: AirFlow | None
    formats: Sequence[str]
    ground: bool | float
    fit: str = OFF
    certificate: bool = False
    obstacles: Sequence[Obstacle] = ()

    def on_another_mesh(self, factor: float) -> "ResolvedScene":
        """Return the same scene in triangles longer by a factor."""
        edge_length, sizing = factor * self.edge_length, self.sizing
        if sizing is not None:
            sizing = replace(
                sizing, size_min=factor * sizing.size_min, size_max=factor * sizing.size_max,
                refine_angle=factor * sizing.refine_angle,
            )  # fmt: skip
        return replace(self, edge_length=edge_length, sizing=sizing, sewing=_sewing(sizing, edge_length))


def resolve(scene: Scene) -> ResolvedScene:
    """Return a scene with every choice made.

    No file is read. Raises InputError if a fabric, a garment's file or a built-in pattern does not exist, or
    if no cloth is like a fabric.
    """
    cloth = [_fabric_of(garment, scene) for garment in scene.garments]
    panel_cloth = [_panel_fabrics(garment, scene) for garment in scene.garments]
    sources = [checked_source(garment) for garment in scene.garments]
    quality = quality_preset(scene.quality)
    edge_length = scene.edge_length or quality.edge_length
    sizing = _sizing(scene.remesh, quality, edge_length)
    return ResolvedScene(
        garments=tuple(
            ResolvedGarment(
                name=name, source=source, fabric=fabric, self_contact=garment.self_contact, pins=garment.pins,
                warp_angle=garment.warp_angle, units=garment.units, up=garment.up,
                walls=garment.walls,
                size=garment.size, allowance=garment.allowance, seams=_seams(garment),
                panel_fabrics=panels, folds=garment.folds, parts=_parts(garment, scene),
            )
            for garment, name, source, fabric, panels in zip(
                scene.garments, _unique_names(scene.garments), sources, cloth, panel_cloth, strict=True
            )
        ),
        avatar=_avatar_source(scene.avatar),
        measurements=_given(scene.measurements),
        quality=quality.name,
        tolerance=quality.tolerance,
        max_frames=scene.max_frames or quality.max_frames,
        edge_length=edge_length,
        sizing=sizing,
        sewing=_sewing(sizing, edge_length),
        gravity=scene.gravity,
        friction=scene.friction,
        friction_between=_friction_between(
            scene.friction_between,
            [
                *(fabric.name for fabric in cloth),
                *(entry.name for panels in panel_cloth for entry in panels.values()),
                "body",
                *(obstacle.called for obstacle in scene.obstacles),
            ],
        ),
        air=None if scene.air is None else scene.air.flow(),
        formats=scene.formats,
        ground=scene.ground,
        fit=scene.fit,
        certificate=scene.certificate,
        obstacles=scene.obstacles,
    )  # fmt: skip


def _seams(garment: Garment) -> Path | tuple[str, ...] | None:
    """Return a garment's seams file or seams. Raises InputError if a length or a text is none."""
    allowance = garment.allowance
    if allowance is not None and not 0.0 <= allowance < 0.2:
        raise InputError(
            f"allowance must lie between 0 and 0.2 m, got {allowance!r}", field="allowance",
            garment=default_name(garment),
        )  # fmt: skip
    if garment.seams is None or isinstance(garment.seams, str | Path):
        return None if garment.seams is None else Path(garment.seams)
    return tuple(garment.seams)


def _fabric_of(garment: Garment, scene: Scene) -> Fabric:
    """Return a garment's fabric, checked."""
    choice = scene.fabric_of(garment)
    # A fabric that the scene has for all is no fault of one garment.
    with about(garment=None if garment.fabric is None else default_name(garment)):
        return _known_fabric(choice, scene, "fabric")


def _panel_fabrics(garment: Garment, scene: Scene) -> dict[str, Fabric]:
    """Return the fabrics of a garment's panels, checked; the panels are known once the garment is read."""
    with about(garment=default_name(garment)):
        return {
            panel: _known_fabric(choice, scene, "panel_fabrics")
            for panel, choice in garment.panel_fabrics.items()
        }


def _parts(garment: Garment, scene: Scene) -> Parts:
    """Return what a garment says of its parts, the fabrics of its layers found and checked."""
    parts = garment.parts
    if not parts.layers:
        return parts
    with about(garment=default_name(garment)):
        layers = [
            layer
            if layer.fabric is None
            else replace(layer, fabric=_known_fabric(layer.fabric, scene, "layer"))
            for layer in parts.layers
        ]
    return replace(parts, layers=tuple(layers))


def _known_fabric(choice: str | Fabric, scene: Scene, field: str) -> Fabric:
    if isinstance(choice, Fabric):
        return checked_fabric(choice)
    known = {**fabrics(), **scene.fabrics}
    if choice not in known:
        raise InputError(unknown_name("fabric", choice, known), field=field)
    return checked_fabric(known[choice])


def _unique_names(garments: Sequence[Garment]) -> list[str]:
    """Return one name per garment, with numbers where two would write the same file."""
    names: list[str] = []
    taken = {"body", "dressed"}
    for garment in garments:
        base = name = default_name(garment)
        number = 2
        while file_stem(name).lower() in taken:
            name = f"{base}_{number}"
            number += 1
        taken.add(file_stem(name).lower())
        names.append(name)
    return names


def _avatar_source(avatar: object) -> AvatarSource:
    """Return where the avatar comes from, by default the built-in mannequin of its own size."""
    if avatar is None:
        return MannequinSize()
    assert isinstance(avatar, Avatar | AvatarFile | MannequinSize), "Scene has checked it"
    return avatar


def _given(measurements: object) -> Given | Path:
    """Return the measurements of a scene, or the file that holds them."""
    if measurements is None:
        return {}
    if isinstance(measurements, str | Path):
        return Path(measurements)
    if isinstance(measurements, Measurements):
        return asdict(measurements)
    if not isinstance(measurements, Mapping):
        raise InputError(
            f"measurements must be Measurements, some of them by name, or a file, got {measurements!r}",
            field="measurements",
        )
    for name in measurements:
        if name not in NAMES:
            raise InputError(unknown_name("measurement", str(name), NAMES), field="measurements")
    return dict(measurements)


def _sizing(remesh: bool | SizingOptions, quality: Quality, edge_length: float) -> SizingOptions | None:
    """Return how the mesh adapts: as the scene says, or as its quality does."""
    if isinstance(remesh, SizingOptions):
        return remesh
    return quality.sizing(edge_length) if remesh else None


def _sewing(sizing: SizingOptions | None, edge_length: float) -> tuple[SewingEdges, ...]:
    """Return the edges to sew in, longer ones where the mesh adapts later."""
    if sizing is not None:
        return tuple(sewing_edges(sizing.size_min, sizing.size_max))
    return tuple(SewingEdges(factor * edge_length, factor * edge_length) for factor in SEWING_FINENESS)


def _friction_between(
    pairs: Mapping[tuple[str, str], float], names: list[str]
) -> dict[frozenset[str], float]:
    """Return the coefficients of named pairs, names checked against what there is."""
    known = dict.fromkeys(names)
    for pair in pairs:
        for name in pair:
            if name not in known:
                raise InputError(
                    f"friction_between: {unknown_name('fabric', name, known)}", field="friction_between"
                )
    return {frozenset(pair): value for pair, value in pairs.items()}
