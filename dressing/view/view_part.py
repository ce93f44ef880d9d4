"""A mesh of a view: body or garment, at one or many times, with fields that colour it."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from toile.dressing.view.packed import Packed
from toile.geometry.arrays import Float, Int

STEPS = 65535
"""Steps of a coordinate over the size of a mesh: 0.01 mm on a shirt. And of a field over its range."""


class Field(NamedTuple):
    """What colours a mesh: a value per face, shape (t,), or per vertex, (m,), and its unit."""

    name: str
    unit: str
    values: Float


class Shape(NamedTuple):
    """Triangles of a mesh.

    faces: into vertices, shape (t, 3). uv: places of the vertices in the pattern [m], shape (m, 2), or None.
    panel: of every face, shape (t,), or None.
    """

    faces: Int
    uv: Float | None = None
    panel: Int | None = None


class Pose(NamedTuple):
    """Vertices [m], shape (m, 3), of the triangles of `shape`, with fields."""

    shape: Shape
    positions: Float
    fields: tuple[Field, ...] = ()


@dataclass(frozen=True, kw_only=True)
class ViewPart:
    """A mesh of a view.

    Attributes
    ----------
    name
        What it is called.
    kind
        "body" or "garment".
    colour
        sRGB, 0 to 1.
    poses
        Where it is, one per frame; those that share a `Shape` object share its triangles.
    panel_names
        One name per panel.
    """

    name: str
    kind: str
    colour: tuple[float, float, float]
    poses: tuple[Pose, ...]
    panel_names: tuple[str, ...] = ()

    def packed(self, block: Packed) -> dict[str, Any]:
        """Put the numbers into a block, and return what the page reads them by."""
        low = np.min([pose.positions.min(axis=0) for pose in self.poses], axis=0)
        high = np.max([pose.positions.max(axis=0) for pose in self.poses], axis=0)
        size = np.maximum(high - low, 1e-9)
        shapes: list[Shape] = []
        frames: list[dict[str, Any]] = []
        ranges = _ranges(self.poses)
        before: Int | None = None
        for pose in self.poses:
            follows = bool(shapes) and shapes[-1] is pose.shape
            if not follows:
                shapes.append(pose.shape)
            steps = np.rint((pose.positions - low) / size * STEPS).astype(np.int32).ravel()
            kept = steps if before is None or not follows else (steps - before) & STEPS
            before = steps
            # Low bytes apart from high ones: between frames most of those are zero, which deflates well.
            planes = np.concatenate([kept & 255, kept >> 8]).astype(np.uint8)
            frames.append(
                {
                    "shape": len(shapes) - 1,
                    "follows": follows,
                    "positions": block.add(planes),
                    "fields": [
                        _packed_field(field, ranges[field.name], pose, block) for field in pose.fields
                    ],
                }
            )
        return {
            "name": self.name,
            "kind": self.kind,
            "colour": [round(part, 4) for part in self.colour],
            "panelNames": list(self.panel_names),
            "low": low.tolist(),
            "size": size.tolist(),
            "shapes": [_packed_shape(shape, block) for shape in shapes],
            "frames": frames,
        }


def _ranges(poses: tuple[Pose, ...]) -> dict[str, list[float]]:
    """Return the range of colours of every field over all frames: without the outermost hundredth."""
    values: dict[str, list[Float]] = {}
    for pose in poses:
        for field in pose.fields:
            values.setdefault(field.name, []).append(field.values)
    ranges = {}
    for name, parts in values.items():
        low, high = np.percentile(np.concatenate(parts), [1.0, 99.0])
        ranges[name] = [float(f"{low:.3g}"), float(f"{high:.3g}")]
    return ranges


def _packed_field(field: Field, limits: list[float], pose: Pose, block: Packed) -> dict[str, Any]:
    """Return a field as the page reads it: whole steps from `low` to `high`."""
    low, high = float(field.values.min(initial=np.inf)), float(field.values.max(initial=-np.inf))
    steps = np.rint((field.values - low) / max(high - low, 1e-300) * STEPS)
    return {
        "name": field.name,
        "unit": field.unit,
        "perFace": len(field.values) == len(pose.shape.faces),
        "low": low,
        "high": high,
        "range": limits,
        "data": block.add(steps.astype(np.uint16)),
    }


def _packed_shape(shape: Shape, block: Packed) -> dict[str, Any]:
    """Return triangles as the page reads them."""
    uv = None
    if shape.uv is not None:
        # Tenths of a millimetre, from the least: a pattern is drawn some hundred pixels high.
        uv = block.add(np.rint(1e4 * (shape.uv - shape.uv.min(axis=0))).astype(np.uint32))
    return {
        "faces": block.indices(shape.faces),
        "uv": uv,
        "panels": None if shape.panel is None else block.indices(shape.panel),
    }
