"""Every force of the engine in a step of its own, for tests of what all have in common."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.engine.forces.added.shapes import ball
from tests.engine.forces.laws.test_stretch_laws import CURVED
from tests.engine.forces.moving_step import MovingStep
from tests.engine.forces.test_bend import unrolled_corners
from tests.engine.forces.test_untangle import bump, pair
from tests.engine.step.test_only_what_is_asked import SLACK, options, sheet
from toile.collide.avatar_surface import AvatarSurface
from toile.engine.cloth.cloth import Cloth
from toile.engine.cloth.creases import Creases
from toile.engine.cloth.fields.edge_runs import EdgeRun
from toile.engine.cloth.fields.fastenings import Fastening
from toile.engine.cloth.fields.fields import Fields, Value
from toile.engine.cloth.fields.gas import Gas
from toile.engine.cloth.fields.keyed import Keyed
from toile.engine.cloth.fields.timed_pins import TimedPins
from toile.engine.cloth.goals import Goals
from toile.engine.forces.added.edge_elastic import EdgeElastic
from toile.engine.forces.added.enclosed_gas import EnclosedGas
from toile.engine.forces.added.fastening_pull import FasteningPull
from toile.engine.forces.added.keyed_membrane import KeyedCurvedMembrane, KeyedMembrane
from toile.engine.forces.added.surface_pressure import SurfacePressure
from toile.engine.forces.added.timed_pull import TimedPull
from toile.engine.forces.air_flow import AirFlow
from toile.engine.forces.bend import Bending, bending_tensor
from toile.engine.forces.force import Force
from toile.engine.forces.goal import GoalPull
from toile.engine.forces.ground import Ground
from toile.engine.forces.hold import Holds, SewingHolds
from toile.engine.forces.laws.bend_damping import BendDamping
from toile.engine.forces.laws.creasing_bending import CreasingBending
from toile.engine.forces.laws.curved_membrane import CurvedMembrane
from toile.engine.forces.laws.fold_hinges import FoldHinges
from toile.engine.forces.laws.stretch_laws import stretch_laws
from toile.engine.forces.membrane import Membrane
from toile.engine.forces.membrane_damping import MembraneDamping
from toile.engine.forces.spring import SpringDamping, Springs
from toile.engine.forces.step_request import StepRequest
from toile.engine.forces.stitch import Stitches
from toile.engine.forces.untangle import Untangling
from toile.engine.forces.wind import Wind
from toile.engine.solve.hessian import Hessian
from toile.engine.step.cloth_forces import cloth_forces
from toile.engine.step.collisions import Collisions
from toile.geometry.arrays import Float
from toile.geometry.normals import vertex_normals
from toile.studies.scenes.flat_meshes import mesh
from toile.studies.validation.validate_curvature import rolled

REQUEST = StepRequest(
    h=0.02, at_rest=False, stitch_share=0.5, stitch_stiffness=40.0, stitch_reach=10.0, hold_stiffness=30.0,
    untangle_stiffness=50.0,
)  # fmt: skip
PAIRS = np.array([(0, 1), (2, 3), (1, 4), (4, 0)], np.int32)


@dataclass(frozen=True)
class Case:
    """A force in a step from `start` that may end at x [m], shapes (n, 3).

    `exact` says that all second derivatives are positive there, so that none is left out. `reach` is how far
    differences go [m].
    """

    force: Force
    start: Float
    x: Float
    exact: bool = True
    request: StepRequest = REQUEST
    reach: float = 1e-6

    def begun(self) -> bool:
        """Begin the step, and find what a force finds where the nodes are."""
        acts = self.force.begin(MovingStep(self.request, self.start), self.start)
        if isinstance(self.force, Collisions):
            self.force.detect(self.x)
        if isinstance(self.force, Untangling):
            self.force.evaluate(self.x)
        return acts

    def gradient(self, x: Float) -> Float:
        total = np.zeros_like(x)
        self.force.add_gradient(x, total)
        return total

    def linearised(self, x: Float) -> tuple[Float, Float]:
        """Gradient, shape (n, 3), and Hessian, shape (3 n, 3 n), as `linearise` adds them."""
        nodes, constant = self.force.nodes, self.force.constant_matrix
        hessian = Hessian(len(x), [] if nodes is None else [nodes])
        total = np.zeros_like(x)
        self.force.linearise(x, total, hessian)
        return total, hessian.to_dense(None if constant is None else constant.toarray())

    def differences(self, of: Callable[[Float], Any]) -> Float:
        """Central differences at x in every direction, shape (3 n, ...)."""
        rows = []
        for entry in range(self.x.size):
            way = np.zeros(self.x.size)
            way[entry] = self.reach
            there, back = self.x + way.reshape(-1, 3), self.x - way.reshape(-1, 3)
            rows.append((np.asarray(of(there)) - np.asarray(of(back))).ravel() / (2.0 * self.reach))
        return np.array(rows)


def piece(compression: float = 0.1) -> tuple[Cloth, Membrane]:
    cloth = sheet(replace(SLACK, compression=compression))
    ones = np.ones(len(cloth.faces))
    return cloth, Membrane(cloth.face_nodes, cloth.rest_corners, 30.0 * ones, 20.0 * ones, 5.0 * ones, 0.1)


def shaken(x: Float, by: float, seed: int = 0) -> Float:
    return np.asarray(x + by * np.random.default_rng(seed).normal(size=x.shape))


def stretched_membrane() -> Case:
    """Along both threads, without shear."""
    cloth, membrane = piece()
    return Case(membrane, cloth.positions, cloth.positions * [1.2, 1.1, 1.0])


def crumpled_membrane() -> Case:
    cloth, membrane = piece()
    return Case(membrane, cloth.positions, shaken(0.8 * cloth.positions, 0.03), exact=False)


def membrane_damping() -> Case:
    cloth, membrane = piece()
    start = shaken(cloth.positions, 0.03)
    return Case(MembraneDamping(membrane, 0.02), start, shaken(start, 0.02, 1))


def springs(share: float) -> Springs:
    x = shaken(np.zeros((5, 3)), 1.0)
    lengths = share * np.linalg.norm(x[PAIRS[:, 0]] - x[PAIRS[:, 1]], axis=1)
    return Springs(PAIRS, lengths, np.array([20.0, 5.0, 10.0, 1.0]))


def lengthened_springs() -> Case:
    x = shaken(np.zeros((5, 3)), 1.0)
    return Case(springs(0.7), x, x)


def shortened_springs() -> Case:
    x = shaken(np.zeros((5, 3)), 1.0)
    return Case(springs(1.4), x, x, exact=False)


def spring_damping() -> Case:
    x = shaken(np.zeros((5, 3)), 1.0)
    return Case(SpringDamping(springs(1.4), 0.01), x, shaken(x, 0.02, 1))


def bending(curved: bool) -> Case:
    points, faces = mesh("random", 1.0, 1.0, 0.25)
    ones = np.ones(len(faces))
    tensor = bending_tensor(ones, 1.5 * ones, 1.2 * ones)
    shape = rolled(points, 0.4, 0.5)
    if not curved:
        force = Bending(faces, np.ascontiguousarray(points[faces]), tensor, len(points))
    else:
        rest = unrolled_corners(shape, faces)
        force = Bending(faces, rest, tensor, len(points), rest_positions=shape)
    return Case(force, shape, shaken(shape, 0.03), exact=not curved)


def stitches(reach: float, share: float = 0.5) -> Case:
    """Four of them, longer than they should be: by more than a reach of 0.1 m, less than one of 10 m."""
    x = shaken(np.zeros((5, 3)), 1.0)
    first = np.linalg.norm(x[PAIRS[:, 0]] - x[PAIRS[:, 1]], axis=1)
    request = replace(REQUEST, stitch_reach=reach, stitch_share=share)
    return Case(Stitches(PAIRS, first), x, x, exact=reach > 1.0 and share < 1.0, request=request)


def short_stitches() -> Case:
    """Some shorter than the share that they have yet, some longer."""
    shares = np.array([1.4, 0.5, 1.2, 0.0])
    case = stitches(10.0)
    return replace(case, exact=False, request=replace(case.request, stitch_share=shares))


def holds() -> Case:
    x = shaken(np.zeros((6, 3)), 1.0)
    axes = np.array([(1, 1, 1), (0, 1, 0), (0.5, 0, 2)], float)
    return Case(Holds(np.array([1, 4, 4], np.int32), shaken(x[:3], 0.1, 1), axes), x, x)


def sewing_holds() -> Case:
    cloth = sheet(SLACK)
    x = shaken(cloth.positions, 0.03)
    weld = replace(cloth, stitches=PAIRS).weld
    force = SewingHolds(
        x, vertex_normals(x, cloth.face_nodes), weld, PAIRS, np.array([1, 9], np.int32)
    )  # fmt: skip
    force.approach(np.linspace(0.0, 1.0, len(x)))
    return Case(force, x, shaken(x, 0.01, 1))


def goal_pull(moving: bool) -> Case:
    cloth = sheet(SLACK)
    count = len(cloth.positions)
    stiffness = np.where(np.arange(count) % 3 > 0, 200.0, 0.0)
    force = GoalPull.for_cloth(
        replace(
            cloth, pinned=np.arange(count) < 4, goals=Goals(stiffness=stiffness, places=cloth.positions + 0.1)
        )
    )
    assert force is not None
    request = replace(REQUEST, pin_target=cloth.positions - 0.2 if moving else None)
    return Case(force, cloth.positions, shaken(cloth.positions, 0.05), request=request)


def wind() -> Case:
    cloth = sheet(SLACK)
    air = AirFlow(velocity=(3.0, -1.0, 2.0), resistance=6.0, friction=2.5)
    start = shaken(cloth.positions, 0.05)
    return Case(Wind(cloth.face_nodes, len(start), air), start, shaken(start, 0.02, 1))


def ground() -> Case:
    """Nodes above and below the floor, none of them near it, that have slid in the step."""
    start = np.array([(0.0, -0.01, 0.0), (0.1, -0.02, 0.0), (0.2, 0.03, 0.1), (0.3, 0.04, 0.0)])
    return Case(Ground(0.01, np.array([1.0, 2.0, 1.5, 1.0]) * 1e-3), start, shaken(start, 1e-3))


def elastic_of_a_hem() -> Case:
    """Elastic along two borders of a sheet, one of them drawn out, one slack."""
    cloth = sheet(SLACK)
    lines = np.array([[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)]])
    runs = tuple(
        EdgeRun(garment=0, panel=0, lines=line[None], rest=rest, stiffness=12.0)
        for line, rest in zip(lines, (0.7, 1.5), strict=True)
    )
    force = EdgeElastic.for_cloth(replace(cloth, elastic=runs))
    assert force is not None
    return Case(force, cloth.positions, shaken(cloth.positions, 0.01))


def pressure() -> Case:
    """On half of a sheet, keyed."""
    cloth = sheet(SLACK)
    half = (cloth.uv[cloth.faces].mean(axis=1)[:, 0] < 0.5).astype(np.int32)
    fields = Fields(region=half, values=({}, {"pressure": Keyed((0.0, 1.0), (50.0, 150.0))}))
    force = SurfacePressure.for_cloth(replace(cloth, fields=fields))
    assert force is not None
    start = shaken(cloth.positions, 0.05)
    return Case(force, start, shaken(start, 0.02, 1), request=replace(REQUEST, seconds=0.3))


def gas(of: Gas) -> Case:
    """In a ball that is dented."""
    cloth = ball(0.1, subdivisions=1)
    (force,) = EnclosedGas.all_of(replace(cloth, gas=(of,)))
    return Case(force, cloth.positions, shaken(cloth.positions, 0.003), exact=False)


def timed_pull() -> Case:
    cloth = sheet(SLACK)
    count = len(cloth.positions)
    pins = TimedPins(
        stiffness=np.where(np.arange(count) % 2 > 0, 200.0, 0.0), places=cloth.positions + 0.1,
        share=Keyed((0.0, 1.0), (1.0, 0.0)),
    )  # fmt: skip
    request = replace(REQUEST, seconds=0.4)
    return Case(TimedPull(pins, cloth), cloth.positions, shaken(cloth.positions, 0.05), request=request)


def keyed_membrane() -> Case:
    """Its rest shape shrinks over the film: at half a second to 0.8 along the warp."""
    cloth = sheet(replace(SLACK, compression=0.1))
    values: dict[str, Value] = {"rest_warp": Keyed((0.0, 1.0), (1.0, 0.6)), "stretch_weft": 30.0}
    fields = Fields(region=np.zeros(len(cloth.faces), np.int32), values=(values,))
    force = KeyedMembrane(replace(cloth, fields=fields))
    request = replace(REQUEST, seconds=0.5)
    return Case(force, cloth.positions, cloth.positions * [1.1, 1.1, 1.0], request=request)


def keyed_curved_membrane() -> Case:
    """The same of a fabric with stretch curves and Poisson's ratio: at half a second it is half as stiff."""
    cloth = sheet(CURVED)
    values: dict[str, Value] = {
        "rest_warp": Keyed((0.0, 1.0), (1.0, 0.96)), "stretch_weft": Keyed((0.0, 1.0), (600.0, 0.01)),
    }  # fmt: skip
    fields = Fields(region=np.zeros(len(cloth.faces), np.int32), values=(values,))
    (force,) = (force for force in cloth_forces(replace(cloth, fields=fields), options())
                if isinstance(force, KeyedCurvedMembrane))  # fmt: skip
    request = replace(REQUEST, seconds=0.5)
    x = shaken(1.02 * cloth.positions, 0.003)
    return Case(force, cloth.positions, x, exact=False, request=request)


def curved_membrane() -> Case:
    """Taut along both threads, on curves that are coupled."""
    curve = ((0.05, 1.0), (0.1, 4.0))
    cloth = sheet(replace(SLACK, stretch_curve_warp=curve, strain_limit=0.3, poisson=0.5))
    stretch, compression = (
        (cloth.per_face("stretch_warp"), cloth.per_face("stretch_weft")),
        np.ones(len(cloth.faces)),
    )
    laws = stretch_laws(cloth.fabrics, cloth.fabric, *stretch, compression)
    assert laws is not None
    force = CurvedMembrane(
        cloth.face_nodes, cloth.rest_corners, stretch, cloth.per_face("shear"), compression, laws
    )
    return Case(force, cloth.positions, cloth.positions * [1.08, 1.07, 1.0])


def bend_damping() -> Case:
    """Its Hessian is a share of the matrix of bending, which is not its own."""
    case = bending(curved=False)
    assert isinstance(case.force, Bending)
    force = BendDamping(case.force, np.full(len(case.force.faces), 0.01))
    return replace(case, force=force, exact=False)


def creasing_bending() -> Case:
    """Bent beyond what it bears where the step starts."""
    stiff = replace(SLACK, bending_warp=1.0, bending_weft=1.0, bending_bias=1.0, crease_curvature=1.0)
    cloth = sheet(stiff)
    cloth = replace(cloth, creases=Creases.of(cloth.fabrics, len(cloth.faces)))
    start = rolled(cloth.uv, 0.4, 0.5)
    return Case(CreasingBending.for_cloth(cloth), start, shaken(start, 0.03), exact=False)


def fold_hinges() -> Case:
    """Two triangles, turned by less than they want; their Hessian is that of Gauss and Newton."""
    x = np.array([(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-0.9, 0.4, 0.1), (0.1, 0.6, 0.8)])
    force = FoldHinges(np.array([(0, 1, 2, 3)], np.int32), np.array([2.0]), np.array([2.5]))
    return Case(force, x, x, exact=False)


def untangling() -> Case:
    """Where it was found what crosses: from there on its springs stay what they are."""
    x, faces = pair(bump(0.012))
    return Case(Untangling(faces, np.arange(len(x), dtype=np.int32), len(x), x.copy()), x, x)


def triangles(places: Float) -> Cloth:
    """Equal triangles of cloth, by themselves, at places [m], shape (t, 3, 3): all nodes have one area."""
    count = len(places)
    flat = np.tile(0.1 * np.array([(1.0, 0.0), (-0.5, 0.75**0.5), (-0.5, -(0.75**0.5))]), (count, 1))
    faces = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    none = np.zeros(count, np.int32)
    return replace(
        sheet(SLACK), positions=places.reshape(-1, 3), velocities=np.zeros((3 * count, 3)),
        node=faces.ravel(), faces=faces, rest_corners=flat[faces], fabric=none, garment=none, panel=none,
        uv=flat, pinned=np.zeros(3 * count, bool), rest_curved=np.zeros(count, bool),
        start_positions=places.reshape(-1, 3),
    )  # fmt: skip


def collisions() -> Case:
    """Two triangles, turned against each other and tilted, close to each other and to one of the avatar.

    Areas are equal, and the avatar's edges far away: else the area of a pair changes with its closest points,
    which the force leaves aside.
    """
    angle = 2.0 * np.pi / 3.0 * np.arange(3) + np.array([[0.1], [1.1]])
    height = np.array([[0.0, 1e-4, 4e-4], [6e-4, 1.0e-3, 7e-4]])
    places = np.stack([0.1 * np.cos(angle), 0.1 * np.sin(angle), height], axis=2)
    places[1, :, 0] += 0.06
    body = np.array([(-5.0, -5.0, -6e-4), (5.0, -5.0, -6e-4), (0.0, 5.0, -6e-4)])
    avatar = AvatarSurface(body, np.array([(0, 1, 2)], np.int32))
    cloth = triangles(places)
    force = Collisions(cloth, avatar, options(self_contact=True))
    return Case(force, cloth.positions, cloth.positions, exact=False, reach=1e-9)


def fastenings() -> Case:
    """Two tilted triangles, fastened on a side and by links, within the largest force and beyond it."""
    places = np.array(
        [
            [(0.0, 0.0, 0.0), (0.3, 0.02, 0.01), (0.05, 0.25, -0.03)],
            [(0.02, 0.03, 0.05), (0.28, 0.0, 0.09), (0.1, 0.2, 0.02)],
        ]
    )
    cloth = replace(triangles(places), panel=np.array([0, 1], np.int32))
    rows = []
    for side, distance, most in (
        (1, 0.01, 100.0),
        (-1, 0.01, 1.0),
        (0, 0.002, 100.0),
        (0, 0.01, 1.0),
        (0, 0.5, 1.0),
    ):
        points = np.array([(0.01, 0.02, 0.0), (-0.02, 0.01, 0.0)])
        rows.append(
            Fastening(
                over=(0, 1), under=(0, 0), over_points=points, under_points=points[::-1].copy(), side=side,
                distance=distance, stiffness=np.array([700.0, 900.0]), most=np.full(2, most), closed=0.75,
            )
        )  # fmt: skip
    force = FasteningPull.for_cloth(replace(cloth, fastenings=tuple(rows)))
    assert force is not None
    return Case(force, cloth.positions, shaken(cloth.positions, 0.003), exact=False)


CASES: dict[str, Callable[[], Case]] = {
    "stretched membrane": stretched_membrane,
    "crumpled membrane": crumpled_membrane,
    "membrane damping": membrane_damping,
    "lengthened springs": lengthened_springs,
    "shortened springs": shortened_springs,
    "spring damping": spring_damping,
    "bending, flat": lambda: bending(curved=False),
    "bending, curved": lambda: bending(curved=True),
    "stitches": lambda: stitches(10.0),
    "stitches to nothing": lambda: stitches(10.0, share=0.0),
    "stitches beyond their reach": lambda: stitches(0.1),
    "short stitches": short_stitches,
    "holds": holds,
    "sewing holds": sewing_holds,
    "goals": lambda: goal_pull(moving=False),
    "moving goals": lambda: goal_pull(moving=True),
    "wind": wind,
    "ground": ground,
    "elastic along edges": elastic_of_a_hem,
    "fastenings": fastenings,
    "pressure": pressure,
    "gas": lambda: gas(Gas(garment=0, volume=5e-3)),
    "timed pins": timed_pull,
    "keyed membrane": keyed_membrane,
    "keyed curved membrane": keyed_curved_membrane,
    "curved membrane": curved_membrane,
    "damping of bending": bend_damping,
    "bending that creases": creasing_bending,
    "folds": fold_hinges,
    "untangling": untangling,
    "collisions": collisions,
}
