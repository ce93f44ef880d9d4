"""Remeshing of cloth in a run: input for the mesher, and the state carried to the new mesh."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, diags_array

from toile.engine.adapt.patch_gate import PatchGate
from toile.engine.adapt.remeshing_record import NOISE, Remeshing
from toile.engine.adapt.sizing_field import face_metrics
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.fields.edge_runs import end_vertices
from toile.engine.forces.goal import GoalPull
from toile.engine.forces.step_request import StepRequest
from toile.engine.forces.wind import Wind
from toile.engine.step.cloth_run import ClothRun
from toile.engine.step.memory import Memory
from toile.engine.step.step import ClothStepper
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected_vertices
from toile.geometry.stage_clock import StageClock
from toile.remesh.adapt.adapt import adapt
from toile.remesh.adapt.momentum import Motion, with_momentum_of
from toile.remesh.adapt.transfer import TransferMap
from toile.remesh.mesh.cloth_mesh import ClothMesh
from toile.remesh.sizing.sizing import SizingOptions
from toile.remesh.sizing.vertex_tensors import vertex_tensors

LEAST_AT_ONCE = 0.008
"""Splits and collapses that are possible at once, as a share of the faces, below which no pass is made: all
that follow from them would hardly come to `FEW`."""
FEW_AT_ONCE = 0.004
"""Collapses in one round, as a share of the faces, below which a pass leaves the rest to the next."""
FEW = 0.02
"""Splits and collapses, as a share of the faces, that are not worth a new mesh: still cloth keeps its own."""
RELAXATIONS, MATCHINGS = 3, 8
"""Steps in which the nodes around remeshed faces settle; at most, in which they give back added energy."""
JUMP = 4.5e-3
"""Added share of the elastic energy that is left as it is."""
BOUND = 5e-3
"""Added share of the elastic energy that a cloth in motion may keep: beyond, it keeps its old mesh."""
HALVINGS = 10
"""Halvings of the way to where the elastic energy is what it was."""


@dataclass(frozen=True, kw_only=True)
class Remeshed:
    """A cloth on its new mesh.

    Attributes
    ----------
    cloth
        The cloth, new nodes half-way on its surface.
    anchors
        Friction anchors of its nodes [m], shape (n, 3); None without contact.
    memory
        What its steps remember, or None.
    changed
        Nodes of the faces that are new or have changed, shape (n,).
    splits, flips, collapses
        What was done.
    """

    cloth: Cloth
    anchors: Float | None
    memory: Memory | None
    changed: Bool
    splits: int
    flips: int
    collapses: int


def remeshed(cloth: Cloth, stepper: ClothStepper, options: SizingOptions) -> Remeshed | None:
    """Adapt the mesh of a cloth to its present shape; None where it is good as it is.

    `cloth` gives the topology, `stepper` the present positions and velocities. Flips and collapses leave the
    cloth free of crossings; momentum is kept.
    """
    mesh = cloth_mesh(cloth, stepper.x)
    tensors = vertex_tensors(mesh, face_metrics(mesh, stepper, options, cloth.rest_scale(cloth.now)))

    gate = PatchGate(cloth, stepper)
    count = len(cloth.faces)
    result = adapt(mesh, tensors, gate, few=int(FEW_AT_ONCE * count), least=int(LEAST_AT_ONCE * count))
    if result.splits + result.collapses <= FEW * count:
        return None
    now = replace(cloth, positions=stepper.x, velocities=stepper.v)
    carried = carried_over(now, result.mesh, result.transfer)
    transfer = result.transfer
    return Remeshed(
        cloth=carried,
        anchors=_anchors(stepper, carried, transfer),
        memory=None if stepper.memory is None else _memory(stepper.memory, transfer),
        changed=_changed_nodes(mesh, carried, transfer),
        splits=result.splits,
        flips=result.flips,
        collapses=result.collapses,
    )


def _anchors(stepper: ClothStepper, carried: Cloth, transfer: TransferMap) -> Float | None:
    """Return friction anchors of a carried cloth [m], shape (n, 3): as far from its nodes as they were."""
    if stepper.collisions is None:
        return None
    slipped = stepper.x - stepper.collisions.anchor[: len(stepper.x)]
    return np.asarray(carried.positions - transfer.at_nodes(slipped))


def _memory(memory: Memory, transfer: TransferMap) -> Memory:
    """Return what steps remember on another mesh; the state before the last step is forgotten."""
    touched = np.asarray(transfer.nodes @ memory.touched.astype(np.float64)) > 0.0
    return Memory(transfer.at_nodes(memory.acceleration), touched)


def remesh_run(
    run: ClothRun, options: SizingOptions, relax: StepRequest, step: int, keep_energy: bool = False
) -> Remeshing | None:
    """Continue a run on a mesh that fits its cloth's present shape; None where it keeps its own.

    Then the nodes around changed faces find their places, by steps `relax` of one Newton iteration, while
    all others stay. With `keep_energy` they do so only as far as it takes to bring the elastic energy back to
    what it was; where that leaves more than `BOUND`, the pass is undone. Velocities keep the momentum that
    they had. `step` is how many steps the run has made.
    """
    stepper = run.stepper
    found = remeshed(run.cloth, stepper, options)
    if found is None:
        return None
    old = replace(run.cloth, positions=stepper.x, velocities=stepper.v)
    before = stepper.elastic_energy()
    former = run.cloth, stepper
    # All that it takes counts as remeshing, not as assembly or contact.
    clock, run.clock = run.clock, StageClock()
    ClothRun.restart(run, found.cloth, found.anchors, found.memory)
    stepper = run.stepper
    velocities = stepper.v
    most = (1.0 + JUMP) * before
    if not keep_energy or stepper.elastic_energy() > most:
        _relax(stepper, _around(found.cloth.face_nodes, found.changed), relax, most if keep_energy else None)
    if keep_energy and stepper.elastic_energy() > (1.0 + BOUND) * before + NOISE:
        run.cloth, run.stepper = former
        run.clock = clock
        return None
    if velocities.any():
        after = replace(found.cloth, positions=stepper.x, velocities=velocities)
        velocities = with_momentum_of(_motion(old), _motion(after))
        velocities[found.cloth.pinned] = found.cloth.velocities[found.cloth.pinned]
    stepper.put(stepper.x, velocities, stepper.memory)
    run.clock = clock
    stepper.book_on(clock)
    return Remeshing(
        step=step, faces=len(found.cloth.faces), splits=found.splits, flips=found.flips,
        collapses=found.collapses, energy_before=before, energy_after=stepper.elastic_energy(),
    )  # fmt: skip


def _relax(stepper: ClothStepper, free: Bool, request: StepRequest, energy: float | None) -> None:
    """Let free nodes, shape (n,), find their places in still air while all others stay.

    With an `energy` [J] they stop on the way where the elastic energy is that, and no goals draw them.
    """
    without = (Wind,) if energy is None else (Wind, GoalPull)
    with stepper.others_still(free, without):
        for _ in range(RELAXATIONS if energy is None else MATCHINGS):
            start = stepper.x.copy()
            stepper.step(request)
            if energy is not None and stepper.elastic_energy() < energy:
                _go_back_to_energy(stepper, start, energy)
                break


def _around(faces: Int, marked: Bool) -> Bool:
    """Mark the nodes of all faces that have a marked one, shape (n,)."""
    wider = marked.copy()
    wider[faces[marked[faces].any(axis=1)].ravel()] = True
    return wider


def _go_back_to_energy(stepper: ClothStepper, start: Float, energy: float) -> None:
    """Put nodes between `start` [m], shape (n, 3), and now: where the elastic energy is `energy` [J]."""
    end = stepper.x.copy()
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        stepper.put(start + middle * (end - start), stepper.v, stepper.memory)
        if stepper.elastic_energy() > energy:
            low = middle
        else:
            high = middle
    stepper.put(start + high * (end - start), stepper.v, stepper.memory)


def cloth_mesh(cloth: Cloth, x: Float) -> ClothMesh:
    """Return what the mesher works on: the rest space is that of the pattern, or the curved start shape."""
    rest = cloth.rest_space
    sides = rest[cloth.faces[:, 1:]] - rest[cloth.faces[:, :1]]
    plane = cloth.rest_corners[:, 1:] - cloth.rest_corners[:, :1]
    frames = np.einsum("tci,tdc->tid", sides, np.linalg.inv(plane))
    parts = cloth.garment.astype(np.int64)
    folded = () if cloth.folds is None else (cloth.folds.part,)
    regions = () if cloth.fields is None else (cloth.fields.region,)
    for part in (cloth.panel, cloth.fabric, *folded, *regions):
        parts = parts * (int(part.max(initial=0)) + 1) + part
    region = np.unique(parts, return_inverse=True)[1]
    kept = np.zeros(len(x), bool)
    kept[cloth.stitches.ravel()] = True
    frozen = _edges_between(cloth.face_nodes, kept)
    runs = [(run.garment, run.panel, run.lines) for run in cloth.elastic]
    runs += [(hold.garment, hold.panel, hold.lines) for hold in cloth.holds if hold.lines is not None]
    for garment, panel, lines in runs:
        own = cloth.faces[(cloth.garment == garment) & (cloth.panel == panel)]
        kept[cloth.node[end_vertices(lines, np.unique(own), rest)]] = True
    return ClothMesh(
        rest=rest,
        node=cloth.node,
        faces=cloth.faces,
        frames=np.ascontiguousarray(frames),
        region=region.astype(np.int32),
        positions=x.copy(),
        kept=kept,
        pinned=cloth.pinned,
        frozen_edges=frozen,
    )


def carried_over(cloth: Cloth, mesh: ClothMesh, transfer: TransferMap) -> Cloth:
    """Return a cloth on its new mesh, everything that belongs to it carried along."""

    def marked(nodes: Int) -> Int:
        mask = np.zeros(len(cloth.positions), bool)
        mask[nodes] = True
        return np.flatnonzero(transfer.marked_nodes(mask)).astype(np.int32)

    # Coordinates of the rest space are taken as the mesher worked with them, all others are interpolated.
    rest_curved = cloth.rest_curved[transfer.faces]
    uv, start = transfer.at_vertices(cloth.uv), transfer.at_vertices(cloth.start_positions)
    flat, curved = mesh.faces[~rest_curved].ravel(), mesh.faces[rest_curved].ravel()
    uv[flat], start[curved] = mesh.rest[flat, :2], mesh.rest[curved]
    after = replace(
        cloth,
        positions=mesh.positions,
        velocities=transfer.at_nodes(cloth.velocities),
        node=mesh.node,
        faces=mesh.faces,
        rest_corners=mesh.rest_corners,
        fabric=cloth.fabric[transfer.faces],
        garment=cloth.garment[transfer.faces],
        panel=cloth.panel[transfer.faces],
        uv=uv,
        stitches=transfer.node_indices(cloth.stitches),
        held=marked(cloth.held),
        waist=marked(cloth.waist),
        pinned=mesh.pinned,
        goals=None if cloth.goals is None else cloth.goals.carried(transfer),
        handles=None if cloth.handles is None else _handles(cloth, mesh.pinned, transfer),
        rest_curved=rest_curved,
        start_positions=start,
        origin=None if cloth.origin is None else cloth.origin.carried(transfer),
        folds=None if cloth.folds is None else cloth.folds.carried(transfer),
        creases=None if cloth.creases is None else cloth.creases.carried(transfer.faces),
        timed_pins=tuple(pins.carried(transfer) for pins in cloth.timed_pins),
    )
    if cloth.fields is not None:
        corners = after.rest_space[after.faces]
        fields = cloth.fields.on(cloth.fields.region[transfer.faces], corners)
        after = replace(after, fields=fields)
    if cloth.velocities.any():
        velocities = with_momentum_of(_motion(cloth), _motion(after))
        velocities[after.pinned] = after.velocities[after.pinned]
        after = replace(after, velocities=velocities)
    return after


def _handles(cloth: Cloth, pinned: Bool, transfer: TransferMap) -> csr_array:
    """Return the weights of moving points in the led nodes of the new mesh, sparse (n', p)."""
    # Goals fade out: a node that is drawn may come to lie between any two.
    led = pinned if cloth.goals is None else np.ones(len(pinned), bool)
    return csr_array(diags_array(led.astype(np.float64)) @ transfer.nodes @ cloth.handles)


def _motion(cloth: Cloth) -> Motion:
    """Return the cloth in motion, its connected pieces told apart."""
    piece = connected_vertices(cloth.face_nodes, len(cloth.positions))
    return Motion(cloth.positions, cloth.velocities, cloth.mass, piece)


def _changed_nodes(mesh: ClothMesh, after: Cloth, transfer: TransferMap) -> Bool:
    """Mark the nodes of faces that were not there before, shape (n,)."""
    old = transfer.new_node[mesh.face_nodes][transfer.faces]
    faces = after.face_nodes
    changed = np.zeros(len(after.positions), bool)
    changed[faces[(old != faces).any(axis=1)].ravel()] = True
    return changed


def _edges_between(faces: Int, marked: Bool) -> Int:
    """Return the edges of faces whose two nodes are marked, shape (k, 2)."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    sides = sides[marked[sides].all(axis=1)]
    return np.ascontiguousarray(np.unique(np.sort(sides, axis=1), axis=0).reshape(-1, 2), np.int32)
