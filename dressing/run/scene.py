"""A scene as the user asks for it: avatar, garments, fabrics, quality."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path
from typing import Any

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.measurements import Measurements
from toile.dressing.body.reading import Reading
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.files.writers.field_mesh import checked_formats
from toile.dressing.garment.fabrics import DEFAULT_FABRIC
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.run.air import Air
from toile.dressing.run.quality import quality_preset
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError
from toile.remesh.sizing.sizing import SizingOptions

OFF = "off"
"""The `lead_in` of an avatar that has none."""
CHECKED = "checked"
FIT_WORDS = (OFF, "maps", CHECKED)
"""What a scene may say of fit."""


@dataclass(frozen=True, kw_only=True)
class AvatarFile:
    """A body still on disk, or one that moves: an .npz, an animated .glb or .usd, or a folder of meshes.

    Attributes
    ----------
    path
        The file or folder.
    units, up
        "m", "cm" or "mm", and "y" or "z"; recognised where None.
    front
        Axis of the file that the body faces, such as "-z"; recognised where None.
    only, without
        Names of the parts that are the body, and of those that are not, with wildcards.
    fps
        Frames per second; None takes the file's own or 24.
    time
        Time of its motion at which it stands still [s], or None: it moves.
    clip
        Name of the animation of a glTF file; None takes the first.
    lead_in
        Length of a motion [s] that leads from the rest pose of its skeleton, in which garments are sewn, into
        a glTF clip; "off" makes none; None makes one of 1 s where sleeves could not be sewn without.
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

    def __post_init__(self) -> None:
        """Accept a path that is a string, and one name for a list of names."""
        object.__setattr__(self, "path", Path(self.path))
        for field_name in ("only", "without"):
            names: object = getattr(self, field_name)
            object.__setattr__(
                self, field_name, (names,) if isinstance(names, str) else tuple(getattr(self, field_name))
            )

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

    def given(self) -> dict[str, float]:
        """Return only the sizes that are set."""
        return {name: value for name, value in vars(self).items() if value is not None}


AvatarSource = Avatar | AvatarFile | MannequinSize
"""A body, or where one comes from."""


@dataclass(frozen=True)
class Garment:
    """One garment of a scene.

    Attributes
    ----------
    source
        Name of a built-in pattern ("tshirt", "circle_skirt", "trousers") or of a registered draft, path of a
        GarmentCode specification (.json), of a DXF-AAMA or ASTM (.dxf) or a FreeSewing pattern (.svg), of a
        3-D mesh (.obj, .ply, .glb, .vtu, .vtk, .xdmf, .inp, .msh, or
        .npz as `read_npz_garment` says) or of a file with a registered reader, or a finished GarmentMesh.
    fabric
        Preset name or Fabric; None takes the scene's.
    name
        Name in output files; None takes it from the source.
    self_contact
        False leaves out contact of cloth with cloth. It only takes effect when all garments of the scene
        opt out: garments are searched together.
    pins
        Edge labels (such as "lower_interface") and numbers of material vertices held in place.
    warp_angle
        Turn of the warp direction in the pattern plane, counter-clockwise seen from the right side
        [degrees]: one number for all panels, or panel name to number.
    panel_fabrics
        Preset name or Fabric of panels that are of another than the garment, by their names.
    units, up
        Units and up axis of a mesh file; None takes the avatar file's if it has one, or recognises them.
        `units` may also be those of a DXF pattern that does not say them.
    walls
        How many layers of cloth the two walls of a mesh with thickness are: 1, of that thickness, or 2.
    size, allowance
        Which size of a DXF pattern, and the seam allowance [m] of outlines without a sew line.
    seams
        Path of the seams file of a DXF or FreeSewing pattern, None for the one beside it; or seams as texts,
        such as "front.3 + back.2 = sleeve.1", which are added to those of a GarmentCode pattern.
    """

    source: str | Path | GarmentMesh
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

    def __post_init__(self) -> None:
        """Raise InputError if `walls` is not 1 or 2."""
        if self.walls not in (1, 2):
            raise InputError(f"walls of a garment are 1 or 2, got {self.walls!r}", field="walls")


@dataclass(frozen=True, kw_only=True)
class Scene:
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
    edge_length
        Edge length of the triangles [m]; None takes the quality's.
    remesh
        Whether the mesh adapts to the folds once the garment is sewn, or how: SizingOptions. The garment is
        then sewn in coarse triangles, and the edge length is that of the finest.
    max_frames
        Frames after which the drape stops; None takes the quality's.
    gravity
        Downward acceleration [m/s^2].
    friction
        Coulomb coefficient against the avatar for all garments; None takes each fabric's.
    friction_between
        Coulomb coefficients of pairs, by the names of two fabrics that are worn, or of one and "body": say,
        {("denim-12oz", "body"): 0.5}. Else each fabric has its own on the body and on itself, and two fabrics
        have the geometric mean of theirs.
    air
        Air that resists garments that follow a body in motion, and may blow: Air; None is a vacuum.
    formats
        Formats in which garments are written beside PLY and OBJ, with their panels, pattern coordinates and
        strain: "vtu", "vtk", "xdmf", "msh" (Gmsh), "inp" (Abaqus; shapes and panels only).
    ground
        Whether there is a floor under the feet of a body that stands, or the height of a floor [m].
    fit
        "maps" writes how the garments fit: pressure on the body, strain, tension and ease; "checked" drapes
        them once more on another mesh, which gives error bars; "off" writes nothing of it.
    certificate
        Whether to write certificate.json, by which `toile verify` checks the result again.
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

    def __post_init__(self) -> None:
        """Accept convenient spellings and check numbers. Raises InputError naming the field."""
        garments: object = self.garments
        if isinstance(garments, str | Path | Garment | GarmentMesh):
            garments = (garments,)
        if not isinstance(garments, list | tuple):
            raise InputError(
                f"garments must be a list of garments, got {type(garments).__name__}", field="garments"
            )
        object.__setattr__(
            self, "garments", tuple(g if isinstance(g, Garment) else Garment(g) for g in garments)
        )
        avatar: object = self.avatar
        if isinstance(avatar, str | Path):
            object.__setattr__(self, "avatar", AvatarFile(path=Path(avatar)))
        if isinstance(self.measurements, str):
            object.__setattr__(self, "measurements", Path(self.measurements))
        if not self.garments:
            raise InputError(
                "the scene has no garment: name a pattern, a mesh or a built-in such as tshirt",
                field="garments",
            )
        quality_preset(self.quality)
        formats = [self.formats] if isinstance(self.formats, str) else self.formats
        object.__setattr__(self, "formats", checked_formats(formats))
        if self.fit not in FIT_WORDS:
            raise InputError(unknown_name("fit", str(self.fit), FIT_WORDS), field="fit")
        _check_number("edge_length", self.edge_length, low=0.001, high=1.0, unit="m")
        _check_number("max_frames", self.max_frames, low=1, high=1_000_000)
        _check_number("gravity", self.gravity, low=0.0, high=1000.0, unit="m/s^2")
        if not isinstance(self.ground, bool):
            _check_number("ground", self.ground, low=-1000.0, high=1000.0, unit="m")
        _check_number("friction", self.friction, low=0.0, high=10.0)
        for pair, value in self.friction_between.items():
            if not isinstance(pair, tuple) or len(pair) != 2:
                raise InputError(
                    f"friction_between: a pair is two names, got {pair!r}", field="friction_between"
                )
            _check_number("friction_between", value, low=0.0, high=10.0, of=" and ".join(map(str, pair)))

    def fabric_of(self, garment: Garment) -> str | Fabric:
        """Return what a garment is made of: a fabric, or the name of one that may not exist."""
        if garment.fabric is not None:
            return garment.fabric
        return DEFAULT_FABRIC if self.fabric is None else self.fabric


def _check_number(
    field: str, value: float | None, *, low: float, high: float, unit: str = "", of: str = ""
) -> None:
    """Raise InputError unless the value is None or lies in [low, high]; `of` says which of several."""
    if value is None:
        return
    if not isinstance(value, int | float) or not math.isfinite(value) or not low <= value <= high:
        between = f"{low:g} and {high:g} {unit}".rstrip()
        what = f"{field} {of}".rstrip()
        raise InputError(f"{what} must lie between {between}, got {value!r}", field=field)
