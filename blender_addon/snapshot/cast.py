"""Who takes part in a run: what the view layer shows, one cast per character."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from toile.blender_addon.problem import Problem


@dataclass(frozen=True)
class AvatarPart:
    """An avatar or obstacle, itself or as an instance of a collection.

    `instance` tells an instance from others of the same object; it is empty for the object itself.
    """

    obj: Any
    instance: tuple[Any, ...] = ()


@dataclass(frozen=True)
class Cast:
    """Garments and avatars that are dressed together among obstacles, apart from all others."""

    avatars: tuple[AvatarPart, ...]
    garments: tuple[Any, ...] = ()
    obstacles: tuple[AvatarPart, ...] = ()


@dataclass
class Roles:
    """The objects of a view layer that play a role, garments from the body outwards.

    `left_out` has a sentence for every object with a role that takes no part.
    """

    avatars: list[AvatarPart] = field(default_factory=list)
    obstacles: list[AvatarPart] = field(default_factory=list)
    garments: list[Any] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)


def roles(context: Any) -> Roles:
    """Return who may take part, as the view layer of a context shows it."""
    found = Roles()
    instanced = _instanced(context)
    layer = context.view_layer
    inside = set(layer.objects)
    hidden = []
    for obj in sorted(context.scene.objects, key=lambda obj: (obj.toile.layer, obj.name)):
        role = obj.toile.role if obj.type == "MESH" else "NONE"
        if role == "NONE":
            continue
        if obj not in inside or not obj.visible_get(view_layer=layer):
            if not any(part.obj == obj for part in instanced):
                hidden.append(obj.name)
        elif role in ("AVATAR", "OBSTACLE"):
            (found.avatars if role == "AVATAR" else found.obstacles).append(AvatarPart(obj))
        elif obj.library is not None:
            found.left_out.append(
                f"'{obj.name}' is linked, so it cannot show frames: make a library override"
            )
        else:
            found.garments.append(obj)
    for part in instanced:
        if part.obj.toile.role != "GARMENT":
            (found.avatars if part.obj.toile.role == "AVATAR" else found.obstacles).append(part)
        else:
            found.left_out.append(
                f"'{part.obj.name}' is in an instance of a collection, so it cannot show frames: make the "
                "instance real, or a library override"
            )
    if hidden:
        names = ", ".join(f"'{name}'" for name in hidden)
        found.left_out.append(f"hidden or excluded in this view layer, and left out: {names}")
    return found


def casts(context: Any, *, only_selected: bool = False) -> tuple[list[Cast], list[str]]:
    """Return who is dressed together, and a sentence for everything that is left out.

    Garments that name their body are dressed with it, its belongings and what nobody claims, such as a floor;
    every other character by itself. Garments without a body go with the only one, or all with everything.
    With `only_selected`, garments that are not selected take no part, nor do avatars if some are selected.
    Raises Problem if somebody is missing.
    """
    found = roles(context)
    garments, avatars = found.garments, found.avatars
    if only_selected:
        garments = [obj for obj in garments if obj.select_get(view_layer=context.view_layer)]
        chosen = [part for part in avatars if not part.instance and part.obj.select_get()]
        avatars = chosen or avatars
    if not avatars:
        raise Problem(
            "; ".join(["no avatar: mark the body as avatar in its Physics properties", *found.left_out])
        )
    if not garments:
        wanted = "no garment is selected: select one" if only_selected and found.garments else (
            "no garment: mark one in its Physics properties, or use Dress This Body"
        )  # fmt: skip
        raise Problem("; ".join([wanted, *found.left_out]))
    present = {part.obj for part in avatars if not part.instance}
    bodies = [body_of(obj, present) for obj in garments]
    named = list(dict.fromkeys(body for body in bodies if body is not None))
    if len(named) < 2:
        return [_cast(found, avatars, garments, named[0] if named else None, named)], found.left_out
    if None in bodies:
        return [Cast(tuple(avatars), tuple(garments), tuple(found.obstacles))], found.left_out
    made = []
    for body in named:
        worn = [obj for obj, its in zip(garments, bodies, strict=True) if its == body]
        made.append(_cast(found, avatars, worn, body, named))
    return made, found.left_out


def _cast(found: Roles, avatars: list[AvatarPart], garments: list[Any], body: Any, named: list[Any]) -> Cast:
    """Return a body with what belongs to it or to nobody, and garments."""
    claimed = _claimed(found, named)
    own, obstacles = (
        tuple(part for part in parts if _serves(part, body, claimed)) for parts in (avatars, found.obstacles)
    )
    return Cast(own, tuple(garments), obstacles)


def body_of(obj: Any, present: set[Any]) -> Any:
    """Return the body that an object belongs to, None if it names none that is present."""
    return obj.toile.body if obj.toile.body in present else None


def _claimed(found: Roles, named: list[Any]) -> set[Any]:
    """Return the avatars that are the body of some garment, shown in this run or not."""
    return {obj.toile.body for obj in found.garments if obj.toile.body is not None} | set(named)


def _serves(part: AvatarPart, body: Any, claimed: set[Any]) -> bool:
    """Whether an avatar or obstacle is that body, belongs to it, or to nobody."""
    if body is None or part.instance:
        return True
    owner = part.obj if part.obj in claimed else part.obj.toile.body
    return owner == body or owner not in claimed


def draft_cast(context: Any, body: Any) -> Cast:
    """Return a body and its belongings, for which a garment is to be drafted; all avatars for None."""
    found = roles(context)
    avatars = [
        part for part in found.avatars
        if body is None or (not part.instance and body in (part.obj, part.obj.toile.body))
    ]  # fmt: skip
    if not avatars:
        raise Problem(
            "; ".join(["no avatar: mark the body as avatar in its Physics properties", *found.left_out])
        )
    return Cast(tuple(avatars))


def placed(parts: tuple[AvatarPart, ...], depsgraph: Any) -> list[tuple[Any, Any]]:
    """Return every part as an object and its matrix in the world, in the present frame."""
    wanted = {part.instance: (part.obj, None) for part in parts if part.instance}
    if wanted:
        for instance in depsgraph.object_instances:
            key = _key(instance)
            if key in wanted:
                wanted[key] = wanted[key][0], instance.matrix_world.copy()
    found = []
    for part in parts:
        obj, matrix = part.obj, None
        if part.instance:
            obj, matrix = wanted[part.instance]
            if matrix is None:
                raise Problem(f"'{obj.name}' is instanced no longer: it must be there in all frames")
        else:
            matrix = obj.evaluated_get(depsgraph).matrix_world
        found.append((obj, np.array(matrix, np.float64)))
    return found


def _instanced(context: Any) -> list[AvatarPart]:
    """Return the instances of mesh objects of collections that play a role."""
    depsgraph = context.evaluated_depsgraph_get()
    holders = (obj for obj in context.view_layer.objects if obj.instance_type == "COLLECTION")
    # A scene may have a hundred thousand instances of grass.
    if not any(
        obj.type == "MESH" and obj.toile.role != "NONE"
        for collection in {holder.instance_collection for holder in holders} - {None}
        for obj in collection.all_objects
    ):
        return []
    found = {}
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.object.type == "MESH":
            obj = instance.object.original
            if obj.toile.role != "NONE":
                found[_key(instance)] = AvatarPart(obj, _key(instance))
    return [found[key] for key in sorted(found)]


def _key(instance: Any) -> tuple[Any, ...]:
    """Return what tells an instance from others, in all frames; empty for an object that is itself."""
    if not instance.is_instance:
        return ()
    parent, obj = instance.parent.original, instance.object.original
    return (parent.name_full, obj.name_full, *instance.persistent_id)
