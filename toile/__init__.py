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
    from toile.dress.air import Air
    from toile.dress.avatar import Avatar, load_avatar
    from toile.dress.batch.batch import JobResult, batch
    from toile.dress.batch.batch_stopped import BatchStopped
    from toile.dress.batch.job import Job
    from toile.dress.dress import dress, resume
    from toile.dress.fabrics import fabric, fabrics
    from toile.dress.garment_mesh import GarmentMesh
    from toile.dress.mannequin import mannequin
    from toile.dress.measure import measure
    from toile.dress.progress import ProgressState
    from toile.dress.result import DressedGarment, Result
    from toile.dress.scene import AvatarFile, Garment, MannequinSize, Scene
    from toile.dress.scene_file import load_scene
    from toile.engine.fabric import Fabric
    from toile.engine.vertex_motion import VertexMotion
    from toile.geometry.errors import InputError

    __version__: str

if not (Path(__file__).parent / "geometry").is_dir():
    raise ImportError(
        "toile was checked out without symbolic links (toile/geometry is not a folder): "
        "enable them with 'git config core.symlinks true' and check out again"
    )

_HOME = {
    "Air": "toile.dress.air",
    "Avatar": "toile.dress.avatar",
    "AvatarFile": "toile.dress.scene",
    "BatchStopped": "toile.dress.batch.batch_stopped",
    "VertexMotion": "toile.engine.vertex_motion",
    "DressedGarment": "toile.dress.result",
    "Fabric": "toile.engine.fabric",
    "Garment": "toile.dress.scene",
    "GarmentMesh": "toile.dress.garment_mesh",
    "InputError": "toile.geometry.errors",
    "Job": "toile.dress.batch.job",
    "JobResult": "toile.dress.batch.batch",
    "MannequinSize": "toile.dress.scene",
    "ProgressState": "toile.dress.progress",
    "Result": "toile.dress.result",
    "Scene": "toile.dress.scene",
    "batch": "toile.dress.batch.batch",
    "fabric": "toile.dress.fabrics",
    "fabrics": "toile.dress.fabrics",
    "load_avatar": "toile.dress.avatar",
    "load_scene": "toile.dress.scene_file",
    "mannequin": "toile.dress.mannequin",
    "measure": "toile.dress.measure",
    "resume": "toile.dress.dress",
}
"""Public name to the module that defines it."""

__all__ = [
    "Air",
    "Avatar",
    "AvatarFile",
    "BatchStopped",
    "DressedGarment",
    "Fabric",
    "Garment",
    "GarmentMesh",
    "InputError",
    "Job",
    "JobResult",
    "MannequinSize",
    "ProgressState",
    "Result",
    "Scene",
    "VertexMotion",
    "batch",
    "dress",
    "fabric",
    "fabrics",
    "load_avatar",
    "load_scene",
    "mannequin",
    "measure",
    "resume",
]


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    if name == "dress":
        # The package of that name; it can be called (see toile/dress/__init__.py).
        return import_module("toile.dress")
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
