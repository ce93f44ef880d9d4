"""A job of a batch: a scene, and the name of its result."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from toile.dressing.body.avatar import Avatar
from toile.dressing.run.garment_source import default_name
from toile.dressing.run.result import file_stem
from toile.dressing.run.scene import AvatarFile, MannequinSize, Scene
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError


@dataclass(frozen=True)
class Job:
    """A scene to dress, and its name: unique within the batch, and the name of the result's folder."""

    name: str
    scene: Scene

    def __post_init__(self) -> None:
        """Raise InputError unless the name can be a folder's."""
        if self.name != file_stem(self.name) or len(self.name) > 200:
            raise InputError(
                f"job name {self.name!r}: use letters, digits, '_', '-' and '.', at most 200, such as "
                f"'{file_stem(self.name)[:200]}'",
                field="name",
            )


@dataclass(frozen=True)
class BadJob:
    """A job that a file of jobs describes wrongly: its name, and what is wrong with it, with its line."""

    name: str
    message: str


def as_jobs(jobs: Iterable[Job | BadJob | Scene]) -> Iterator[Job | BadJob]:
    """Yield jobs one by one; a scene without a name gets one from its body, garments and fabrics."""
    for job in jobs:
        yield job if isinstance(job, Job | BadJob) else Job(job_name(job), job)


def job_name(scene: Scene) -> str:
    """Return a name made of the scene's body, garments and fabrics: `body__shirt__denim-12oz`."""
    garments = "+".join(default_name(garment) for garment in scene.garments)
    fabrics = {_fabric_name(garment.fabric or scene.fabric) for garment in scene.garments} - {""}
    parts = [avatar_name(scene), garments, "+".join(sorted(fabrics))]
    return "__".join(file_stem(part.replace("+", "-")) for part in parts if part)


def avatar_name(scene: Scene) -> str:
    """Return what the scene's body is called."""
    avatar = scene.avatar
    if isinstance(avatar, AvatarFile):
        return avatar.path.stem
    if isinstance(avatar, Avatar):
        return avatar.name
    if isinstance(avatar, MannequinSize):
        sizes = (f"{name[0]}{100.0 * value:g}" for name, value in avatar.given().items())
        return "-".join(("mannequin", *sizes))
    return "mannequin"


def fabric_names(scene: Scene) -> str:
    """Return the names of the fabrics of the scene's garments."""
    return " ".join(_fabric_name(scene.fabric_of(garment)) for garment in scene.garments)


def _fabric_name(fabric: str | Fabric | None) -> str:
    """Return a fabric's name, empty where it is the default."""
    return "" if fabric is None else fabric if isinstance(fabric, str) else fabric.name
