"""A scene as the user asks for it: avatar, garments, fabrics, quality."""

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex

import numpy.typing as npt

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.measurements import Measurements
from toile.dressing.body.obstacles.obstacle import Obstacle, given_obstacles
from toile.dressing.body.posing.posed_body import given_poses
from toile.dressing.body.reading import Reading
from toile.dressing.files.writers.field_mesh import checked_formats
from toile.dressing.fit.fit_words import check_fit
from toile.dressing.garment.fabrics import DEFAULT_FABRIC
from toile.dressing.garment.fields.closure import Closure
from toile.dressing.garment.fields.field import Elastic, Field, Filling, Hold, Parts
from toile.dressing.garment.fields.layer import Layer
from toile.dressing.garment.fields.patch import Patch
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.given_values import (
    check_fabric,
    check_fabrics,
    checked_text,
    given_friction,
    given_garment,
    given_ground,
    given_names,
    given_path,
    given_pins,
    given_real,
    given_remesh,
    given_warp,
)
from toile.dressing.pattern.pattern import Fold, Pattern
from toile.dressing.run.air import Air
from toile.dressing.run.quality import quality_preset
from toile.engine.cloth.fabric import Fabric
from toile.geometry.by_value import ByValue
from toile.geometry.errors import InputError
from toile.geometry.given_numbers import real, shown, truth, whole
from toile.geometry.threads.crew import MOST_THREADS
from toile.remesh.sizing.sizing import SizingOptions

OFF = "off"  # the `lead_in` of an avatar that has none


@dataclass(frozen=True, kw_only=True)
class AvatarFile:
    """A body still on disk, or one that moves: an .npz, an animated .glb or .usd, or a folder of meshes.

    Attributes
    ----------
    path
        The file or folder.
    units, up, front
        "m", "cm" or "mm"; "y" or "z"; axis of the file that the body faces, such as "-z"; None: recognised.
    only, without
        Names of the parts that are the body, and of those that are not, with wildcards.
    fps, time
        Frames per second, None: the file's own or 24; time at which it stands still [s], None: it moves.
    clip
        Name of the animation of a glTF file; None takes the first.
    lead_in
        Length of a motion [s] that leads from the rest pose of its skeleton, or from open arms, in which
        garments are sewn, into its clip; "off" makes none; None makes one of 1 s where sleeves could not be
        sewn without, and opens and closes the arms of a body that stands.
    pose
        Files of the body in other poses, to which it moves; FILE@SECONDS is a glTF clip as it stands then.
    """

    path: Path
    units: str | None = None
    up: str | None = None
    front: str | None = None
    only: Sequence[str] = ()
    without: Sequence[str] = ()
    fps: float | None = None
    time: float | None = None
    clip: str | None = None
    lead_in: float | str | None = None
    pose: Sequence[str | Path] = ()

    if TYPE_CHECKING:

        def __init__(
            self, *, path: str | Path, units: str | None = None, up: str | None = None,
            front: str | None = None, only: str | Sequence[str] = (), without: str | Sequence[str] = (),
            fps: SupportsFloat | None = None, time: SupportsFloat | None = None, clip: str | None = None,
            lead_in: SupportsFloat | str | None = None, pose: str | Path | Sequence[str | Path] = (),
        ) -> None: ...  # fmt: skip

    def __post_init__(self) -> None:
        """Accept convenient spellings. Raises InputError naming a field of a wrong type."""
        _set(self, path=given_path(self.path, "path"), pose=given_poses(self.pose))
        for name in ("only", "without"):
            _set(self, **{name: given_names(getattr(self, name), name)})
        for name in ("units", "up", "front", "clip"):
            checked_text(getattr(self, name), name)
        for name in ("fps", "time", "lead_in"):
            _set(self, **{name: given_real(getattr(self, name), name, words=name == "lead_in")})

    @property
    def reading(self) -> Reading:
        """What is known of the file."""
        return Reading(
            units=self.units, up=self.up, front=self.front, only=tuple(self.only), without=tuple(self.without)
        )


@dataclass(frozen=True, kw_only=True)
class MannequinSize:
    """Size of the built-in mannequin [m]: height and circumferences; None keeps its default."""

    height: float | None = None
    chest: float | None = None
    waist: float | None = None
    hip: float | None = None

    if TYPE_CHECKING:

        def __init__(
            self, *, height: SupportsFloat | None = None, chest: SupportsFloat | None = None,
            waist: SupportsFloat | None = None, hip: SupportsFloat | None = None,
        ) -> None: ...  # fmt: skip

    def __post_init__(self) -> None:
        """Raise InputError naming a size that is no number."""
        for name, value in vars(self).items():
            _set(self, **{name: given_real(value, name)})

    def given(self) -> dict[str, float]:
        """Return only the sizes that are set."""
        return {name: value for name, value in vars(self).items() if value is not None}


AvatarSource = Avatar | AvatarFile | MannequinSize
"""A body, or where one comes from."""


@dataclass(frozen=True, eq=False)
class Garment(ByValue):
    """One garment of a scene.

    Attributes
    ----------
    source
        Name of a built-in pattern ("tshirt", "circle_skirt", "trousers") or of a registered draft, path of a
        GarmentCode specification (.json), of a DXF-AAMA or ASTM (.dxf) or a FreeSewing pattern (.svg), of a
        3-D mesh (.obj, .ply, .glb, .vtu, .vtk, .xdmf, .inp, .msh, or
        .npz as `read_npz_garment` says) or of a file with a registered reader; a Pattern, or a GarmentCode
        specification as a dictionary; or a finished GarmentMesh.
    fabric
        Preset name or Fabric; None takes the scene's.
    name
        Name in output files; None takes it from the source.
    self_contact
        False leaves out contact of cloth with cloth. It only takes effect when all garments of the scene
        opt out: garments are searched together.
    pins
        Edge labels (such as "lower_interface") and numbers of material vertices held in place: where the
        garment starts, or, of panels to be sewn, where the closed seams and the body have put them.
    warp_angle
        Turn of the warp direction in the pattern plane, counter-clockwise seen from the right side
        [degrees]: one number for all panels, or panel name to number.
    panel_fabrics
        Preset name or Fabric of panels that are of another than the garment, by their names.
    folds
        Lines along which panels are folded at rest, by panel: fold lines and pleats of a pattern.
    units, up
        Units and up axis of a mesh file; None takes the avatar file's if it has one, or recognises them.
        `units` may also be those of a DXF pattern.
    walls
        How many layers of cloth the two walls of a mesh with thickness are: 1, of that thickness, or 2.
    size, allowance
        Which size of a DXF pattern, and the seam allowance [m] of outlines without a sew line.
    seams
        Path of the seams file of a DXF or FreeSewing pattern, None for the one beside it; or seams as texts,
        such as "front.3 + back.2 = sleeve.1", which are added to those of a GarmentCode pattern.
    fields, elastic, holds, gas, closures, patches, layers
        Values on parts, elastic, holds of a film, gas, buttons and zips, pockets, linings: Field and so on.
    """

    source: str | Path | GarmentMesh | Pattern
    _: KW_ONLY
    fabric: str | Fabric | None = None
    name: str | None = None
    self_contact: bool = True
    pins: tuple[str | int, ...] = ()
    warp_angle: float | Mapping[str, float] = 0.0
    units: str | None = None
    up: str | None = None
    walls: int = 1
    size: str | None = None
    allowance: float | None = None
    seams: str | Path | Sequence[str] | None = None
    panel_fabrics: Mapping[str, str | Fabric] = field(default_factory=dict)
    folds: Mapping[str, Sequence[Fold]] = field(default_factory=dict)
    fields: Sequence[Field] = ()
    elastic: Sequence[Elastic] = ()
    holds: Sequence[Hold] = ()
    gas: Filling | None = None
    closures: Sequence[Closure] = ()
    patches: Sequence[Patch] = ()
    layers: Sequence[Layer] = ()

    @property
    def parts(self) -> Parts:
        """All that it says of its parts."""
        listed = ("fields", "elastic", "holds", "closures", "patches", "layers")
        return Parts(gas=self.gas, **{name: tuple(getattr(self, name)) for name in listed})

    if TYPE_CHECKING:

        def __init__(
            self, source: "GarmentLike", *, fabric: str | Fabric | None = None, name: str | None = None,
            self_contact: bool = True, pins: str | Sequence[str | SupportsIndex] | npt.NDArray[Any] = (),
            warp_angle: SupportsFloat | Mapping[str, SupportsFloat] = 0.0, units: str | None = None,
            up: str | None = None, walls: SupportsIndex = 1, size: str | None = None,
            allowance: SupportsFloat | None = None, seams: str | Path | Sequence[str] | None = None,
            panel_fabrics: Mapping[str, str | Fabric] = ..., folds: Mapping[str, Sequence[Fold]] = ...,
            fields: Sequence[Field] = (),
            elastic: Sequence[Elastic] = (), holds: Sequence[Hold] = (), gas: Filling | None = None,
            closures: Sequence[Closure] = (), patches: Sequence[Patch] = (), layers: Sequence[Layer] = (),
        ) -> None: ...  # fmt: skip

    def __post_init__(self) -> None:
        """Accept convenient spellings. Raises InputError naming a field of a wrong type or value."""
        _set(self, source=given_garment(self.source))
        check_fabric(self.fabric, "fabric")
        for name in ("name", "units", "up", "size"):
            checked_text(getattr(self, name), name)
        _set(self, self_contact=truth(self.self_contact, "self_contact"), pins=given_pins(self.pins))
        _set(self, warp_angle=given_warp(self.warp_angle), allowance=given_real(self.allowance, "allowance"))
        if self.walls not in (1, 2) or isinstance(self.walls, bool):
            raise InputError(f"walls of a garment are 1 or 2, got {shown(self.walls)}", field="walls")
        _set(self, walls=int(self.walls))
        if self.seams is not None and not isinstance(self.seams, str | Path):
            _set(self, seams=given_names(self.seams, "seams"))
        if not isinstance(self.panel_fabrics, Mapping):
            raise InputError(
                f"panel_fabrics must be fabrics by the names of panels, got {shown(self.panel_fabrics)}",
                field="panel_fabrics",
            )
        for fabric in self.panel_fabrics.values():
            check_fabric(fabric, "panel_fabrics")


GarmentLike = str | Path | GarmentMesh | Pattern | Mapping[str, Any]
"""What a garment may be made from."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene(ByValue):
    """Everything a drape needs to know; nothing is read or built before `toile.dress(scene)`.

    Attributes
    ----------
    garments
        Garments from the body outwards; a name or path stands for a Garment with defaults.
    avatar
        The body: an Avatar, a file, or a mannequin size; None is the built-in mannequin.
    measurements
        Measurements of the body that are used instead of those toile takes [m, rad]: a Measurements, some of
        its fields by name, or a TOML or JSON file of them [cm, degrees]. A body that cannot be measured (it
        sits, or holds its arms at its sides) has the mannequin's proportions in what is not given.
    fabric
        Preset name or Fabric of garments that name none; None is cotton-poplin.
    fabrics
        User-defined fabrics by name; they win over presets of the same name.
    quality
        "preview", "standard" or "accurate".
    edge_length, max_frames
        Edges of the triangles [m], frames after which the drape stops; None takes the quality's.
    remesh
        Whether the mesh adapts to the folds once the garment is sewn, or how: SizingOptions. The garment is
        then sewn in coarse triangles, and the edge length is that of the finest.
    gravity
        Downward acceleration [m/s^2].
    friction
        Coulomb coefficient against the avatar for all garments; None takes each fabric's.
    friction_between
        Coulomb coefficients of pairs of fabrics that are worn, or of one and "body": {("denim-12oz", "body"):
        0.5}. Else each has its own on the body and on itself, and two have the geometric mean of theirs.
    air
        Air that resists garments that follow a body in motion, and may blow: Air; None is a vacuum.
    formats
        Formats in which garments are written beside PLY and OBJ, with their panels, pattern coordinates and
        strain: "vtu", "vtk", "xdmf", "msh" (Gmsh), "inp" (Abaqus; shapes and panels only). Of films: "glb",
        one animated moving.glb of all; "mdd", a point cache per garment, whose mesh must stay (remesh=False).
    obstacles, ground
        Solids beside the body; whether there is a floor under its feet, or the height of a floor [m].
    fit, certificate
        "maps" or "checked" (with error bars) writes how garments fit; True writes certificate.json.
    threads
        How many threads share the work; None is one. The result is the same with any number.
    """

    garments: Sequence[Garment]
    avatar: AvatarSource | str | Path | None = None
    measurements: Measurements | Mapping[str, Any] | str | Path | None = None
    fabric: str | Fabric | None = None
    fabrics: Mapping[str, Fabric] = field(default_factory=dict)
    quality: str = "standard"
    edge_length: float | None = None
    remesh: bool | SizingOptions = True
    max_frames: int | None = None
    gravity: float = 9.81
    friction: float | None = None
    friction_between: Mapping[tuple[str, str], float] = field(default_factory=dict)
    air: Air | None = None
    formats: Sequence[str] = ()
    ground: bool | float = True
    fit: str = "off"
    certificate: bool = False
    obstacles: Sequence[Obstacle] = ()
    threads: int | None = field(default=None, compare=False)

    if TYPE_CHECKING:

        def __init__(
            self, *, garments: Sequence[Garment | GarmentLike] | Garment | GarmentLike,
            avatar: AvatarSource | str | Path | None = None,
            measurements: Measurements | Mapping[str, Any] | str | Path | None = None,
            fabric: str | Fabric | None = None, fabrics: Mapping[str, Fabric] = ...,
            quality: str = "standard", edge_length: SupportsFloat | None = None, fit: str = "off",
            remesh: bool | SizingOptions = True, max_frames: SupportsIndex | None = None,
            gravity: SupportsFloat = 9.81, friction: SupportsFloat | None = None, certificate: bool = False,
            friction_between: Mapping[tuple[str, str], SupportsFloat] = ..., air: Air | None = None,
            formats: str | Sequence[str] = (), ground: bool | SupportsFloat = True,
            obstacles: Sequence[Obstacle | str | Path | Avatar] = (), threads: SupportsIndex | None = None,
        ) -> None: ...  # fmt: skip

    def __post_init__(self) -> None:
        """Accept convenient spellings and check everything. Raises InputError naming the field."""
        _set(self, garments=_garments(self.garments))
        if isinstance(self.avatar, str | Path):
            _set(self, avatar=AvatarFile(path=self.avatar))
        if not isinstance(self.avatar, Avatar | AvatarFile | MannequinSize | None):
            raise InputError(
                f"avatar must be an Avatar, a file or a mannequin size, got {shown(self.avatar)}",
                field="avatar",
            )
        if isinstance(self.measurements, str):
            _set(self, measurements=Path(self.measurements))
        check_fabric(self.fabric, "fabric")
        check_fabrics(self.fabrics)
        checked_text(self.quality, "quality")
        quality_preset(self.quality)
        check_fit(self.fit)
        formats: str | Sequence[str] = self.formats
        _set(self, formats=checked_formats([formats] if isinstance(formats, str) else formats))
        for name, low, high, unit in NUMBERS:
            if getattr(self, name) is not None:
                _set(self, **{name: real(getattr(self, name), name, low, high, unit)})
        for count, most in (("max_frames", 1_000_000), ("threads", MOST_THREADS)):
            if getattr(self, count) is not None:
                _set(self, **{count: whole(getattr(self, count), count, 1, most)})
        _set(self, remesh=given_remesh(self.remesh), ground=given_ground(self.ground))
        _set(self, obstacles=given_obstacles(self.obstacles))
        if not isinstance(self.air, Air | None):
            raise InputError(
                f"air must be an Air, such as Air(velocity=(0, 0, 5)), got {shown(self.air)}", field="air"
            )
        _set(self, friction_between=given_friction(self.friction_between))

    def fabric_of(self, garment: Garment) -> str | Fabric:
        """Return what a garment is made of: a fabric, or the name of one that may not exist."""
        if garment.fabric is not None:
            return garment.fabric
        return DEFAULT_FABRIC if self.fabric is None else self.fabric


NUMBERS = (
    ("edge_length", 0.001, 1.0, "m"),
    ("gravity", 0.0, 1000.0, "m/s^2"),
    ("friction", 0.0, 10.0, ""),
)
"""Fields of a scene that are numbers, their limits and units."""


def _set(instance: object, **values: object) -> None:
    """Set fields of a frozen dataclass that is being made."""
    for name, value in values.items():
        object.__setattr__(instance, name, value)


def _garments(given: object) -> tuple[Garment, ...]:
    """Return garments, given as a list or as one. Raises InputError if there is none."""
    if isinstance(given, str | Path | Garment | GarmentMesh | Pattern | Mapping):
        given = (given,)
    if not isinstance(given, list | tuple):
        raise InputError(f"garments must be a list of garments, got {type(given).__name__}", field="garments")
    if not given:
        raise InputError(
            "the scene has no garment: name a pattern, a mesh or a built-in such as tshirt", field="garments"
        )
    return tuple(entry if isinstance(entry, Garment) else Garment(entry) for entry in given)
