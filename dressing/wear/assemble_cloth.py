"""Assembly of a scene's garment meshes into one Cloth."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array, diags_array

from toile.dressing.garment.fields.layered_fabric import layered
from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.pattern.roles import HANGS_FROM, SITS_ON
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.creases import Creases
from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.fields.fields import Fields, Value
from toile.engine.cloth.fields.paintings import VertexPainting
from toile.engine.cloth.folds import FoldLine, Folds
from toile.engine.cloth.goals import Goals
from toile.engine.cloth.origin import Origin
from toile.engine.cloth.vertex_motion import VertexMotion
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.errors import InputError

FOLD_WIDTH = 1e-3
"""Over which cloth bends at a fold that says nothing else [m]: that of a pressed fold."""


def assemble_cloth(garments: list[tuple[GarmentMesh, Fabric]], pins: list[Int]) -> Cloth:
    """Join garments into one Cloth at rest; every material vertex starts as a node of its own.

    `pins` names material vertices that are pinned where they start, one array per garment, beside those that
    its mesh pins.
    """
    offsets = np.cumsum([0] + [len(mesh.positions) for mesh, _ in garments])
    seams = np.cumsum([0] + [len(mesh.seam_names) for mesh, _ in garments])
    fabrics = tuple(
        dict.fromkeys(
            entry
            for mesh, fabric in garments
            for entry in (fabric, *mesh.panel_fabrics.values(), *_layered_fabrics(mesh, fabric).values())
        )
    )
    positions = np.concatenate([mesh.positions for mesh, _ in garments])
    count = len(positions)
    pinned = np.zeros(count, bool)
    for offset, nodes in zip(offsets, pins, strict=False):
        pinned[offset + nodes] = True
    for offset, (mesh, _) in zip(offsets, garments, strict=False):
        pinned[offset + mesh.pinned] = True
    stitches = np.concatenate(
        [mesh.stitches.reshape(-1, 2) + offset for (mesh, _), offset in zip(garments, offsets, strict=False)]
    ).astype(np.int32)
    held, waist = [np.empty(0, np.int32)], [np.empty(0, np.int32)]
    for (mesh, _), offset in zip(garments, offsets, strict=False):
        held += [vertices + offset for vertices in (*mesh.held.values(), *mesh.edges.values())]
        # What hangs from the shoulders finds its own height; what sits on the waist needs friction first.
        if not any(role in mesh.edges for role in HANGS_FROM):
            waist += [mesh.edges[role] + offset for role in SITS_ON if role in mesh.edges]

    def per_face(values: list[int], kind: type) -> Any:
        return np.concatenate(
            [np.full(len(mesh.faces), value, kind) for (mesh, _), value in zip(garments, values, strict=True)]
        )

    goals = Goals.together(
        [
            None if mesh.pull is None else Goals(stiffness=mesh.pull, places=mesh.positions)
            for mesh, _ in garments
        ],
        [mesh.positions for mesh, _ in garments],
    )
    fabric_of = np.concatenate([_fabric_of_faces(mesh, fabric, fabrics) for mesh, fabric in garments])
    folds = Folds.together([mesh.folds for mesh, _ in garments], [len(mesh.faces) for mesh, _ in garments])
    led = pinned if goals is None else np.ones(count, bool)
    origin = Origin.together(
        [mesh.origin for mesh, _ in garments],
        [(len(mesh.positions), len(mesh.faces)) for mesh, _ in garments],
    )
    cloth = Cloth(
        positions=positions,
        velocities=np.zeros_like(positions),
        node=np.arange(count, dtype=np.int32),
        faces=np.concatenate(
            [mesh.faces + offset for (mesh, _), offset in zip(garments, offsets, strict=False)]
        ).astype(np.int32),
        rest_corners=np.concatenate([mesh.rest_corners for mesh, _ in garments]),
        fabrics=fabrics,
        fabric=fabric_of,
        garment=per_face(list(range(len(garments))), np.int32),
        panel=np.concatenate([mesh.panel for mesh, _ in garments]),
        uv=np.concatenate([mesh.uv for mesh, _ in garments]),
        stitches=stitches,
        seam=np.concatenate(
            [mesh.seam + seam for (mesh, _), seam in zip(garments, seams, strict=False)]
        ).astype(np.int32),
        stitch_length=np.linalg.norm(positions[stitches[:, 0]] - positions[stitches[:, 1]], axis=1),
        held=np.unique(np.concatenate(held)).astype(np.int32),
        waist=np.unique(np.concatenate(waist)).astype(np.int32),
        pinned=pinned,
        rest_curved=per_face([not mesh.flat for mesh, _ in garments], np.bool_),
        start_positions=positions.copy(),
        origin=origin,
        goals=goals,
        handles=_handles(origin, led, [mesh for mesh, _ in garments]),
        creases=Creases.of(fabrics, len(fabric_of)),
        folds=None if folds is None else _stiffened(folds, fabrics, fabric_of),
        gas=tuple(replace(gas, garment=k) for k, (mesh, _) in enumerate(garments) for gas in mesh.gas),
        fastenings=tuple(
            row.of_garment(k) for k, (mesh, _) in enumerate(garments) for row in mesh.fastenings
        ),
    )
    return _with_parts(cloth, [mesh for mesh, _ in garments], offsets)


def _with_parts(cloth: Cloth, meshes: list[GarmentMesh], offsets: Int) -> Cloth:
    """Return a cloth with what lies on edges of its garments, and their fields.

    Their first material vertices are `offsets`.
    """
    if any(mesh.elastic or mesh.holds for mesh in meshes):
        rest = cloth.rest_space
        cloth = replace(
            cloth,
            elastic=tuple(
                replace(run, garment=k, lines=rest[offsets[k] + sides])
                for k, mesh in enumerate(meshes)
                for run, sides in mesh.elastic
            ),
            holds=tuple(
                replace(hold, garment=k, lines=None if sides is None else rest[offsets[k] + sides])
                for k, mesh in enumerate(meshes)
                for hold, sides in mesh.holds
            ),
        )
    return _with_fields(cloth, meshes, offsets)


def _with_fields(cloth: Cloth, meshes: list[GarmentMesh], offsets: Int) -> Cloth:
    """Return a cloth with the fields of its garments, whose first material vertices are `offsets`."""
    parts = [mesh.fields for mesh in meshes]
    fields = Fields.together(parts, [len(mesh.faces) for mesh in meshes])
    if fields is None:
        return cloth
    rest = cloth.rest_space
    owner = np.repeat(np.arange(len(parts)), [1 if part is None else len(part.values) for part in parts])
    placed = tuple(
        {name: _placed(value, rest[offsets[index] : offsets[index + 1]]) for name, value in values.items()}
        for index, values in zip(owner.tolist(), fields.values, strict=True)
    )
    fields = replace(fields, values=placed)
    return replace(cloth, fields=fields.on(fields.region, rest[cloth.faces]))


def _placed(value: Value, rest: Float) -> Value:
    """Return a value of a field on a garment whose vertices lie at `rest` in rest space [m], shape (m, 3)."""
    return replace(value, points=rest) if isinstance(value, VertexPainting) else value


def _fabric_of_faces(mesh: GarmentMesh, fabric: Fabric, fabrics: tuple[Fabric, ...]) -> Int:
    """Return the index of the fabric of every face of a garment: its panel's, or the garment's."""
    of_panel = [fabrics.index(mesh.panel_fabrics.get(name, fabric)) for name in mesh.panel_names]
    found: Int = np.array(of_panel, np.int32)[mesh.panel]
    for (panel, stack), together in _layered_fabrics(mesh, fabric).items():
        assert mesh.layers is not None
        found[(mesh.panel == panel) & (mesh.layers.stack == stack)] = fabrics.index(together)
    return found


def _layered_fabrics(mesh: GarmentMesh, fabric: Fabric) -> dict[tuple[int, int], Fabric]:
    """Return the fabric of every panel with every stack of layers that lies on it, by both numbers."""
    if mesh.layers is None:
        return {}
    pairs = np.unique(np.column_stack([mesh.panel, mesh.layers.stack]), axis=0)
    return {
        (panel, stack): layered(
            mesh.panel_fabrics.get(mesh.panel_names[panel], fabric), mesh.layers.stacks[stack]
        )
        for panel, stack in pairs.tolist()
        if mesh.layers.stacks[stack]
    }


def _stiffened(folds: Folds, fabrics: tuple[Fabric, ...], fabric: Int) -> Folds:
    """Return folds with the stiffness [N] of the fabric of their panel where they have none of their own."""

    def usual(line: FoldLine) -> float:
        some = fabrics[fabric[np.isin(folds.part, line.parts).argmax()]]
        return float(0.5 * (some.bending_warp + some.bending_weft) / FOLD_WIDTH)

    lines = [
        line._replace(stiffness=usual(line)) if np.isnan(line.stiffness) else line for line in folds.lines
    ]
    return replace(folds, lines=tuple(lines))


def pin_motion(meshes: list[GarmentMesh], origin: Origin | None) -> VertexMotion | None:
    """Return where the corners of garments go, one garment after the other; None if none of them moves.

    Raises InputError if their motions differ in length.
    """
    moving = [mesh.motion for mesh in meshes if mesh.motion is not None]
    if not moving or origin is None:
        return None
    lengths = sorted({len(motion.frames) for motion in moving})
    if len(lengths) > 1:
        raise InputError(
            f"motions of pins differ in length ({lengths} frames); give all the same", field="motion"
        )
    parts = [
        np.zeros((lengths[0], count, 3), np.float32) if mesh.motion is None else mesh.motion.frames
        for mesh, count in zip(meshes, np.diff(origin.first).tolist(), strict=True)
    ]
    return VertexMotion(frames=np.concatenate(parts, axis=1), fps=moving[0].fps)


def _handles(origin: Origin | None, led: Bool, meshes: list[GarmentMesh]) -> csr_array | None:
    """Return how nodes that are led follow corners that move, sparse (n, p); None if none does."""
    if origin is None or all(mesh.motion is None for mesh in meshes):
        return None
    moves = np.repeat([mesh.motion is not None for mesh in meshes], [len(mesh.positions) for mesh in meshes])
    return csr_array(diags_array((led & moves).astype(np.float64)) @ origin.weights)
