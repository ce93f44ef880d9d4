"""The source of a garment: built-in pattern, file or mesh."""

from pathlib import Path

from toile.dressing.files.on_disk import is_file
from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.readers import garment_formats
from toile.dressing.pattern.drafts import built_in_names
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.run.scene import Garment
from toile.geometry.errors import InputError, about

GarmentSource = str | Path | GarmentMesh | Pattern
"""The name of a built-in pattern, a file, a mesh, or a pattern."""


def checked_source(garment: Garment) -> GarmentSource:
    """Return what a garment is made from, unread. Raises InputError if that does not exist."""
    source = garment.source
    if isinstance(source, GarmentMesh | Pattern):
        return source
    if name := built_in_name(source):
        return name
    path = Path(source)
    with about(garment=default_name(garment), field="source"):
        if not path.suffix and not is_file(path):
            known = unknown_name("garment", str(source), built_in_names())
            raise InputError(f"{known} (a pattern or mesh file needs its extension)")
        with about(file=path):
            _check_file(path)
    return path


def _check_file(path: Path) -> None:
    """Raise InputError if there is no garment file of that name."""
    if path.suffix.lower() not in garment_formats():
        kind = path.suffix or "(no extension)"
        raise InputError(f"{path}: unknown garment format '{kind}'; use {', '.join(garment_formats())}")
    if not is_file(path):
        raise InputError(f"{path}: garment file not found; check the path")
    if not path.stat().st_size:
        raise InputError(f"{path}: the file is empty; export the garment again")


def built_in_name(source: str | Path | GarmentMesh | Pattern) -> str | None:
    """Return the name of the built-in pattern that a source means, as in "T-shirt"; None if it means none."""
    if not isinstance(source, str | Path):
        return None
    plain = "".join(letter for letter in str(source).lower() if letter not in "-_ ")
    return next((name for name in built_in_names() if name.replace("_", "") == plain), None)


def default_name(garment: Garment) -> str:
    """Return the garment's name, or the one its source suggests."""
    if garment.name:
        return garment.name
    if isinstance(garment.source, GarmentMesh | Pattern):
        return garment.source.name
    name = built_in_name(garment.source)
    return name or Path(garment.source).name.split(".")[0].removesuffix("_specification")
