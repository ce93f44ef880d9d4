"""Puts garments on bodies.

    import toile

    scene = toile.Scene(garments=[toile.Garment("tshirt", fabric="cotton-interlock")])
    result = toile.dress(scene, output="out")

Names are loaded when first used, so that importing toile costs nothing.
"""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from toile.dressing.batch.batch import JobResult, batch
    from toile.dressing.batch.batch_stopped import BatchStopped
    from toile.dressing.batch.job import Job
    from toile.dressing.body.avatar import Avatar, load_avatar
    from toile.dressing.body.in_memory.body_in_memory import body
    from toile.dressing.body.mannequin import mannequin
    from toile.dressing.body.measure import measure
    from toile.dressing.body.measurements import Measurements
    from toile.dressing.body.obstacles.obstacle import Obstacle, ObstacleKey
    from toile.dressing.garment.fabrics import fabric, fabrics
    from toile.dressing.garment.fields.closure import Closure
    from toile.dressing.garment.fields.field import Elastic, Field, Filling, Hold, Painted, Textured
    from toile.dressing.garment.fields.layer import Layer
    from toile.dressing.garment.fields.patch import Patch
    from toile.dressing.garment.garment_mesh import GarmentMesh
    from toile.dressing.garment.readers import register_reader
    from toile.dressing.live.live_scene import Live, live
    from toile.dressing.live.sheet import Sheet
    from toile.dressing.pattern.drafts import register_draft
    from toile.dressing.pattern.garmentcode_write import write_garmentcode
    from toile.dressing.pattern.pattern import Edge, Fold, Panel, Pattern, Stitch
    from toile.dressing.pattern.seam import EdgePart, Seam, read_seam
    from toile.dressing.run.air import Air
    from toile.dressing.run.dress import dress, resume
    from toile.dressing.run.output import report_schema
    from toile.dressing.run.progress import ProgressState
    from toile.dressing.run.result import DressedGarment, Result
    from toile.dressing.run.scene import AvatarFile, Garment, MannequinSize, Scene
    from toile.dressing.run.scene_file import load_scene
    from toile.dressing.wear.drape_types import Failure
    from toile.engine.cloth.fabric import Fabric
    from toile.engine.cloth.fields.keyed import Keyed
    from toile.engine.cloth.vertex_motion import VertexMotion
    from toile.engine.forces.fan import Fan
    from toile.geometry.errors import InputError
    from toile.remesh.sizing.sizing import SizingOptions

    __version__: str

if not (Path(__file__).parent / "geometry").is_dir():
    # A checkout without symbolic links, as on Windows: the packages lie one folder up.
    __path__ = [*__path__, str(Path(__file__).resolve().parents[1])]

_HOME = {
    "Air": "toile.dressing.run.air",
    "Avatar": "toile.dressing.body.avatar",
    "AvatarFile": "toile.dressing.run.scene",
    "BatchStopped": "toile.dressing.batch.batch_stopped",
    "Closure": "toile.dressing.garment.fields.closure",
    "DressedGarment": "toile.dressing.run.result",
    "Edge": "toile.dressing.pattern.pattern",
    "EdgePart": "toile.dressing.pattern.seam",
    "Elastic": "toile.dressing.garment.fields.field",
    "Fabric": "toile.engine.cloth.fabric",
    "Failure": "toile.dressing.wear.drape_types",
    "Fan": "toile.engine.forces.fan",
    "Field": "toile.dressing.garment.fields.field",
    "Filling": "toile.dressing.garment.fields.field",
    "Fold": "toile.dressing.pattern.pattern",
    "Garment": "toile.dressing.run.scene",
    "GarmentMesh": "toile.dressing.garment.garment_mesh",
    "Hold": "toile.dressing.garment.fields.field",
    "InputError": "toile.geometry.errors",
    "Job": "toile.dressing.batch.job",
    "JobResult": "toile.dressing.batch.batch",
    "Keyed": "toile.engine.cloth.fields.keyed",
    "Layer": "toile.dressing.garment.fields.layer",
    "Live": "toile.dressing.live.live_scene",
    "MannequinSize": "toile.dressing.run.scene",
    "Measurements": "toile.dressing.body.measurements",
    "Obstacle": "toile.dressing.body.obstacles.obstacle",
    "ObstacleKey": "toile.dressing.body.obstacles.obstacle",
    "Painted": "toile.dressing.garment.fields.field",
    "Panel": "toile.dressing.pattern.pattern",
    "Patch": "toile.dressing.garment.fields.patch",
    "Pattern": "toile.dressing.pattern.pattern",
    "ProgressState": "toile.dressing.run.progress",
    "Result": "toile.dressing.run.result",
    "Scene": "toile.dressing.run.scene",
    "Seam": "toile.dressing.pattern.seam",
    "Sheet": "toile.dressing.live.sheet",
    "SizingOptions": "toile.remesh.sizing.sizing",
    "Stitch": "toile.dressing.pattern.pattern",
    "Textured": "toile.dressing.garment.fields.field",
    "VertexMotion": "toile.engine.cloth.vertex_motion",
    "batch": "toile.dressing.batch.batch",
    "body": "toile.dressing.body.in_memory.body_in_memory",
    "dress": "toile.dressing.run.dress",
    "fabric": "toile.dressing.garment.fabrics",
    "fabrics": "toile.dressing.garment.fabrics",
    "live": "toile.dressing.live.live_scene",
    "load_avatar": "toile.dressing.body.avatar",
    "load_scene": "toile.dressing.run.scene_file",
    "mannequin": "toile.dressing.body.mannequin",
    "measure": "toile.dressing.body.measure",
    "read_seam": "toile.dressing.pattern.seam",
    "register_draft": "toile.dressing.pattern.drafts",
    "register_reader": "toile.dressing.garment.readers",
    "report_schema": "toile.dressing.run.output",
    "resume": "toile.dressing.run.dress",
    "write_garmentcode": "toile.dressing.pattern.garmentcode_write",
}
"""Public name to the module that defines it."""

__all__ = [
    "Air",
    "Avatar",
    "AvatarFile",
    "BatchStopped",
    "Closure",
    "DressedGarment",
    "Edge",
    "EdgePart",
    "Elastic",
    "Fabric",
    "Failure",
    "Fan",
    "Field",
    "Filling",
    "Fold",
    "Garment",
    "GarmentMesh",
    "Hold",
    "InputError",
    "Job",
    "JobResult",
    "Keyed",
    "Layer",
    "Live",
    "MannequinSize",
    "Measurements",
    "Obstacle",
    "ObstacleKey",
    "Painted",
    "Panel",
    "Patch",
    "Pattern",
    "ProgressState",
    "Result",
    "Scene",
    "Seam",
    "Sheet",
    "SizingOptions",
    "Stitch",
    "Textured",
    "VertexMotion",
    "batch",
    "body",
    "dress",
    "fabric",
    "fabrics",
    "live",
    "load_avatar",
    "load_scene",
    "mannequin",
    "measure",
    "read_seam",
    "register_draft",
    "register_reader",
    "report_schema",
    "resume",
    "write_garmentcode",
]


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    if name == "__version__":
        from importlib.metadata import version

        return version("toile")
    if name not in _HOME:
        raise AttributeError(f"module 'toile' has no attribute '{name}'")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names."""
    return sorted({*globals(), *__all__, "__version__"})
