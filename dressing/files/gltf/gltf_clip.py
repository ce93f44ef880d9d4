"""One animation of a glTF file: its name, and its keys by node and what they move.

Khronos Group, glTF 2.0 specification, section 3.11.
"""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from toile.dressing.files.gltf.gltf_channel import Channel
from toile.dressing.files.gltf.gltf_file import GltfFile
from toile.dressing.files.suggestion import unknown_name
from toile.geometry.errors import InputError

KINDS = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3", "weights": "SCALAR"}
"""What a channel can move, to the type of its values."""
STAND_STILL = "; export it without animation, or give a time (--time 0) to dress the body as it stands then"


@dataclass(frozen=True, kw_only=True)
class Clip:
    """An animation.

    Attributes
    ----------
    title
        What messages call it.
    channels
        Keys, by number of the node and what they move.
    others
        Names of the animations beside it.
    """

    title: str
    channels: dict[tuple[int, str], Channel]
    others: tuple[str, ...]

    @property
    def start(self) -> float:
        """Time of the first key [s]."""
        return float(min(channel.times[0] for channel in self.channels.values()))

    @property
    def end(self) -> float:
        """Time of the last key [s]."""
        return float(max(channel.times[-1] for channel in self.channels.values()))

    def note(self, read: str) -> str:
        """Return a sentence on what was read of it, such as "of 3 s was read", and what was not."""
        left = ""
        if self.others:
            listed = ", ".join(self.others[:5]) + (", ..." if len(self.others) > 5 else "")
            left = (
                f", {len(self.others)} more not: what belongs together must be one animation; "
                f"clip names another ({listed})"
            )
        sentence = f"{self.title} {read}{left}."
        return sentence[0].upper() + sentence[1:]


def read_clip(file: GltfFile, name: str | None) -> Clip:
    """Return the animation of a name, or the first.

    Those without a name are called by their number, from 0. Raises InputError if there is none of that name,
    or if its keys are broken.
    """
    entries = file.content.get("animations") or []
    names = [str(entry.get("name", number)) for number, entry in enumerate(entries)]
    if name is not None and name not in names:
        what = unknown_name("clip", name, names) if names else f"no clip '{name}': it holds no animation"
        raise InputError(f"{file.path}: {what}", file=file.path, field="clip")
    number = 0 if name is None else names.index(name)
    entry = file.entry("animations", number)
    quoted = f"({json.dumps(entry['name'], ensure_ascii=False)})" if "name" in entry else ""
    title = f"the first animation {quoted}" if name is None else f"animation {quoted or number}"
    title = title.strip()
    channels = _channels(file, number, entry)
    if not channels:
        raise file.error(f"{title} moves neither nodes nor morph targets", STAND_STILL)
    return Clip(title=title, channels=channels, others=tuple(n for k, n in enumerate(names) if k != number))


def _channels(file: GltfFile, number: int, animation: dict[str, Any]) -> dict[tuple[int, str], Channel]:
    """Channels of the animation by node and what they move; those of other things are left out."""
    channels: dict[tuple[int, str], Channel] = {}
    for index, entry in enumerate(animation["channels"]):
        target = entry["target"]
        if "node" not in target or target["path"] not in KINDS:
            continue
        node = file.entry("nodes", target["node"])
        if "matrix" in node and target["path"] != "weights":
            raise file.error(
                f"nodes[{target['node']}] is animated but has a matrix",
                "; export it with translation, rotation and scale",
            )
        place = f"animations[{number}].channels[{index}]"
        sampler = entry["sampler"]
        if isinstance(sampler, bool) or not 0 <= sampler < len(animation["samplers"]):
            raise file.error(f"{place} refers to sampler {sampler}, which does not exist")
        channels[target["node"], target["path"]] = _channel(
            file, animation["samplers"][sampler], target["path"], place
        )
    return channels


def _channel(file: GltfFile, sampler: dict[str, Any], path: str, place: str) -> Channel:
    """Keys of one channel."""
    times = file.numbers(sampler["input"], "SCALAR")[:, 0]
    if not len(times) or (np.diff(times) <= 0.0).any():
        raise file.error(f"{place}: the times of its keys do not rise")
    values = file.numbers(sampler["output"], KINDS[path])
    way = sampler.get("interpolation", "LINEAR")
    if way not in ("LINEAR", "STEP", "CUBICSPLINE"):
        raise file.error(f"{place}: unknown interpolation {way!r}; use LINEAR, STEP or CUBICSPLINE", "")
    per_key = 3 if way == "CUBICSPLINE" else 1
    # Several morph weights per key are so many scalars.
    width = values.size // (per_key * len(times)) if path == "weights" else values.shape[1]
    if width < 1 or values.size != per_key * len(times) * width:
        raise file.error(f"{place} has {len(times)} keys, but {len(values)} values")
    keyed = values.reshape(len(times), per_key, width)
    return Channel(
        times=times,
        values=np.ascontiguousarray(keyed[:, per_key // 2]),
        tangents=np.ascontiguousarray(keyed[:, [0, 2]].swapaxes(0, 1)) if per_key == 3 else None,
        is_step=way == "STEP",
        is_rotation=path == "rotation",
    )
