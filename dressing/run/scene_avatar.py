"""Loading of a scene's avatar."""

from pathlib import Path

from toile.dressing.body.animated_avatar import is_animated, load_animated_avatar, load_posed_avatar
from toile.dressing.body.avatar import Avatar, load_avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.body.given_measurements import Given, read_measurements
from toile.dressing.body.in_memory.body_in_memory import sound
from toile.dressing.body.posing.posed_body import given_poses, load_posed_body
from toile.dressing.run.scene import OFF, AvatarFile, AvatarSource
from toile.geometry.errors import InputError, about


def load_scene_avatar(source: AvatarSource) -> Avatar:
    """Return the avatar, read or built. Raises InputError naming the file or the size at fault."""
    if isinstance(source, Avatar):
        with about(field="avatar"):
            return sound(source)
    with about(field="avatar"):
        if isinstance(source, AvatarFile):
            return _read(source)
        sizes = source.given()
        if not sizes:
            from toile.dressing.body.stored_mannequin import stored_mannequin

            return stored_mannequin()
        from toile.dressing.body.mannequin import mannequin

        return mannequin(**sizes)


def load_dress_form(source: AvatarSource, measurements: Given | Path) -> tuple[Avatar, DressForm]:
    """Return the avatar in its room, and on its form with given measurements, or those of a file."""
    avatar = load_scene_avatar(source)
    if isinstance(measurements, Path):
        measurements = read_measurements(measurements)
    return avatar, DressForm(avatar, measurements)


def _read(file: AvatarFile) -> Avatar:
    """Return the avatar of a file or folder, with its motion if it has one and no time is given."""
    if file.pose:
        _check_still(file)
        return load_posed_body(file.path, given_poses(file.pose), reading=file.reading, fps=file.fps)
    if is_animated(file.path):
        if file.time is not None:
            return load_posed_avatar(
                file.path, time=file.time, reading=file.reading, fps=file.fps, clip=file.clip
            )
        return load_animated_avatar(file.path, reading=file.reading, fps=file.fps, clip=file.clip)
    for field in ("fps", "time", "clip", "lead_in"):
        value = getattr(file, field)
        if value is not None and not (field == "lead_in" and value == OFF):
            raise InputError(
                f"{file.path}: {field} is for an avatar that moves; give an .npz, an animated .glb or a "
                "folder of meshes",
                file=file.path,
                field=field,
            )
    return load_avatar(
        file.path, units=file.units, up=file.up, front=file.front, only=file.only, without=file.without
    )


def _check_still(file: AvatarFile) -> None:
    """Raise InputError where a body is to move to poses that moves by itself."""
    if is_animated(file.path) and file.time is None:
        raise InputError(
            f"{file.path}: moves by itself, and pose is for a body that stands; leave one out, or export its "
            "pose of rest as a mesh",
            file=file.path,
            field="pose",
        )
    for field in ("time", "clip"):
        if getattr(file, field) is not None:
            raise InputError(
                f"{file.path}: {field} is for an avatar that moves; write {file.path.name}@SECONDS as a pose",
                file=file.path,
                field=field,
            )
