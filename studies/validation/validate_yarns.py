"""Yarns: swatches of woven cloth beside closed forms, other models and the engine's triangles.

The fabric of most numbers is a poplin of 20 tex, 25 x 25 yarns per centimetre, in SI units.
"""

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from toile.engine.cloth.fabric import Fabric
from toile.engine.cloth.flat_cloth import flat_cloth
from toile.engine.swatch.equilibrium import Patch
from toile.engine.swatch.net import Net, Strand, woven_net
from toile.geometry.arrays import Bool, Float
from toile.studies.scenes.motion import free_stepper
from toile.studies.validation.validate_cantilever import ELASTICA
from toile.studies.validation.validate_stretch import PULL
from toile.studies.validation.validation_row import ValidationRow, absolute_row, relative_row

SPACING, WAVE, BENDING, STIFFNESS, DENSITY = 4e-4, 1.67e-4, 1.8e-9, 60.0, 2e-5
PLAIN = np.array([[True, False], [False, True]])
UNIT_CELL = (
    (1.0, 0.00084, -0.00084, 0.1662e-3, 0.17e-3), (10.0, 0.00781, -0.00815, 0.1594e-3, 1.60e-3),
    (50.0, 0.02970, -0.03658, 0.1355e-3, 6.90e-3), (100.0, 0.04556, -0.06473, 0.1150e-3, 11.91e-3),
    (250.0, 0.06656, -0.12051, 0.0807e-3, 21.65e-3), (500.0, 0.07852, -0.17030, 0.0551e-3, 30.59e-3),
    (1000.0, 0.08750, -0.21666, 0.0343e-3, 39.43e-3),
)  # fmt: skip
"""Tension [N/m], strains along and across, wave height [m], force between the yarns [N] of one crossing that
minimises its energy by itself: three unknowns."""
PRINTED = 2e-5
"""Half the last digit of the strains above, and what a free border adds to them in the middle of 20 x 20."""
GRAVITY = 9.81


def strand(**changed: float) -> Strand:
    """Return the yarn of the poplin, or one with other numbers."""
    numbers = {
        "stiffness": STIFFNESS, "bending": BENDING, "linear_density": DENSITY, "width": 1e-4,
        "spacing": SPACING, "wave": WAVE, "set": 1.0,
    }  # fmt: skip
    return Strand(**{**numbers, **changed})


def square(count: int, yarn: Strand, *, shear: float = 0.0, squeeze: float = 0.0) -> tuple[Net, Float]:
    """Return a square of plain weave at rest."""
    return woven_net(PLAIN, np.ones((count, count), bool), (yarn, yarn), shear, squeeze)


def stuck(net: Net, *, flat: bool) -> Bool:
    """Return that all places and waves are free and no yarn slides, shape (2 n, 3)."""
    free = np.ones((2 * net.crossings, 3), bool)
    free[: net.crossings, 2] = not flat
    free[net.crossings :, :2] = False
    return free


def validate_yarns() -> Iterator[ValidationRow]:
    """Compare swatches with everything that says what they should do."""
    yield from _uniaxial()
    yield from _first_stiffness()
    yield from _shear()
    yield from _bias()
    yield from _cantilever()
    yield from _friction()
    yield from _held_patch()
    yield from _cycle()
    yield from _triangles()


def _pulled(yarn: Strand, tensions: list[float], count: int = 20) -> Iterator[tuple[Patch, Net]]:
    """Pull a square along its warp."""
    net, state = square(count, yarn)
    free = stuck(net, flat=True)
    free[net.grid[:, 0], 0] = False
    free[net.grid[count // 2, 0], 1] = False
    patch = Patch(net, state, free)
    for tension in tensions:
        patch.pull[net.grid[:, -1], 0] = tension * SPACING
        patch.settle()
        yield patch, net


def _strains(patch: Patch, net: Net) -> tuple[float, float]:
    """Return strains of the middle along and across."""
    x, c = patch.state[net.grid], len(net.grid) // 2
    along = (x[c, c + 2, 0] - x[c, c - 2, 0]) / (4.0 * SPACING) - 1.0
    across = (x[c + 2, c, 1] - x[c - 2, c, 1]) / (4.0 * SPACING) - 1.0
    return float(along), float(across)


def _uniaxial() -> Iterator[ValidationRow]:
    ((patch, net),) = _pulled(strand(wave=0.0), [100.0])
    yield relative_row(
        "yarns", "straight", "stiffness [N/m]", 100.0 / _strains(patch, net)[0], 150_000.0, 1e-3
    )
    states = _pulled(strand(), [row[0] for row in UNIT_CELL])
    for (tension, along, across, wave, force), (patch, net) in zip(UNIT_CELL, states, strict=True):
        found = _strains(patch, net)
        middle = net.grid[10, 10]
        name = f"waved, {tension:g} N/m"
        yield absolute_row("yarns", name, "strain along", found[0], along, 0.005 * along + PRINTED)
        yield absolute_row("yarns", name, "strain across", found[1], across, -0.005 * across + PRINTED)
        height = net.half_height + patch.state[net.crossings + middle, 2]
        yield absolute_row("yarns", name, "wave [mm]", 1e3 * height, 1e3 * wave, 0.4e-3 * 1.0)
        pressed = float(patch.contact_forces()[middle].mean())
        yield absolute_row(
            "yarns", name, "force between yarns [mN]", 1e3 * pressed, 1e3 * force, 10.0 * force + 5e-3
        )


def _first_stiffness() -> Iterator[ValidationRow]:
    """Pull a square so large that what its borders do does not reach its middle: 10 crossings."""
    slope = math.atan(WAVE / SPACING)
    length = math.hypot(WAVE, SPACING)
    for keeps in (1.0, 0.0):
        expected = (
            8.0
            * BENDING
            * (1.0 + (1.0 - keeps) * slope * math.tan(slope))
            / (SPACING**2 * length * math.tan(slope) ** 2)
        )
        at = [_strains(patch, net)[0] for patch, net in _pulled(strand(set=keeps), [0.0, 1.0], 30)]
        yield relative_row(
            "yarns", f"waved, set {keeps:g}", "first stiffness [N/m]", 1.0 / (at[1] - at[0]), expected, 1.0
        )


def _shear() -> Iterator[ValidationRow]:
    modulus = 100.0
    for width in (0.5, 0.7):
        net, rest = square(8, strand(width=width * SPACING), shear=modulus, squeeze=1e7)
        grid, free = net.grid, stuck(net, flat=True)
        border = np.unique(np.concatenate([grid[0], grid[-1], grid[:, 0], grid[:, -1]]))
        free[border] = False
        patch = Patch(net, rest, free)
        y, area = rest[border, 1], float(np.ptp(rest[: net.crossings, 0])) ** 2
        lock = None
        for degrees in (*np.arange(2.0, 40.0, 2.0), *np.arange(40.0, 70.0, 0.5)):
            angle = math.radians(degrees)
            patch.state[border, 0] = rest[border, 0] + y * math.sin(angle)
            patch.state[border, 1] = y * math.cos(angle)
            patch.settle()
            motion = np.column_stack([y * math.cos(angle), -y * math.sin(angle)])
            stiffness = float((patch.reactions()[border, :2] * motion).sum()) / area / angle
            if degrees == 30.0:
                yield relative_row(
                    "yarns", f"width {width:g}", "shear stiffness [N/m]", stiffness, modulus, 0.1
                )
            elif degrees > 30.0 and lock is None and stiffness > 1.02 * modulus:
                lock = degrees
        yield absolute_row(
            "yarns",
            f"width {width:g}",
            "locks at [deg]",
            lock or math.nan,
            math.degrees(math.acos(width)),
            1.0,
        )


def _bias() -> Iterator[ValidationRow]:
    """Pull a strip cut at 45 degrees of yarns that hardly stretch, three times as high as wide."""
    cells, lift = 36, 0.1
    half = cells * SPACING / 2.0
    count = math.ceil(4.0 * cells / math.sqrt(2.0)) + 3
    at = (np.arange(count) - (count - 1) / 2.0) * SPACING / math.sqrt(2.0)
    along, across = at[None, :] + at[:, None], at[None, :] - at[:, None]
    there = (np.abs(along) <= 3.0 * half + 1e-9) & (np.abs(across) <= half + 1e-9)
    yarn = strand(wave=0.0, bending=1e-15)
    net, rest = woven_net(PLAIN, there, (yarn, yarn), 1.0, 0.0)
    along, across = along[there], across[there]
    high, wide = float(np.ptp(along)), float(np.ptp(across))
    free = np.zeros_like(rest, dtype=bool)
    ends = np.abs(along) > along.max() - 1e-9
    free[: net.crossings, :2] = ~ends[:, None]
    patch = Patch(net, rest, free)
    direction = np.array([1.0, 1.0, 0.0]) / math.sqrt(2.0)
    step = (lift * (high - wide) / 20.0) * np.clip(2.0 * along / high, -1.0, 1.0)[:, None] * direction
    for number in range(1, 11):
        moved = np.ones_like(ends) if number == 1 else ends
        patch.state[: net.crossings][moved] = (rest[: net.crossings] + number * step)[moved]
        patch.settle()
    angle = math.pi / 2.0 - 2.0 * math.acos((1.0 + lift) / math.sqrt(2.0))
    zones = 0.5 * (wide * (high - 1.5 * wide) * angle**2 + wide**2 * (angle / 2.0) ** 2)
    yield absolute_row(
        "yarns", "bias, 36 cells", "energy over three zones", patch.stored() / zones, 0.97, 0.01
    )


def _cantilever() -> Iterator[ValidationRow]:
    """Let strips of four warps sag; only the warps have weight."""
    for count, bar in ((41, 3.0), (81, 1.0)):
        for gamma in (1.0, 10.0):
            length = math.hypot(SPACING, WAVE)
            rigidity, overhang = BENDING / length, (count - 1.5) * SPACING
            density = gamma * rigidity / overhang**3 / GRAVITY * SPACING**2 / length
            net, state = woven_net(
                PLAIN, np.ones((4, count), bool),
                (strand(linear_density=density), strand(linear_density=0.0)), 20.0, 0.0,
            )  # fmt: skip
            free = stuck(net, flat=False)
            free[net.grid[:, :2].ravel()] = False
            patch = Patch(net, state, free)
            for share in np.arange(0.1, 1.05, 0.1):
                patch.gravity = np.array([0.0, 0.0, -GRAVITY * share])
                patch.settle()
            tip = patch.state[net.grid[1, -1]]
            found = -float(tip[2]) / (float(tip[0]) - 0.5 * SPACING)
            yield relative_row(
                "yarns",
                f"cantilever, {count} crossings",
                f"H/W at Gamma {gamma:g}",
                found,
                ELASTICA[gamma],
                bar,
            )


def _one_yarn(count: int, yarn: Strand, friction: float, grip: float, pressed: float | None) -> Patch:
    """Return one warp yarn whose places are held; it slides through all crossings but the last."""
    net, state = woven_net(PLAIN, np.ones((1, count), bool), (yarn, yarn), 0.0, 0.0)
    free = np.zeros_like(state, dtype=bool)
    free[net.slide(net.grid[0, :-1]), 0] = True
    given = np.full((count, 2), pressed if pressed is not None else 0.0)
    return Patch(
        net,
        state,
        free,
        friction=friction,
        grip=grip,
        pressed=given,
        given=pressed is not None,
        precise=1e-8,
    )


def _drawn(patch: Patch, steps: int, step: float) -> list[float]:
    """Draw a yarn by its last crossing; return the forces [N]."""
    end, forces = patch.net.slide(patch.net.grid[0, -1:])[0], []
    for _ in range(steps):
        patch.state[end, 0] -= step
        patch.settle()
        forces.append(-float(patch.reactions()[end, 0]))
    return forces


def _friction() -> Iterator[ValidationRow]:
    for friction in (0.1, 0.3):
        for count in (10, 40):
            patch = _one_yarn(count, strand(wave=0.0), friction, 1e5, 5e-3)
            force = _drawn(patch, 40, 1e-7 * count)[-1]
            name = f"{count} crossings, mu {friction:g}"
            yield relative_row("yarns", name, "drawing force [mN]", 1e3 * force, count * friction * 5.0, 1e-4)
    patch = _one_yarn(200, strand(wave=0.0), 0.3, 1e6, 5e-3)
    force = _drawn(patch, 25, 1e-7)[-1]
    partial = math.sqrt(2.0 * 0.3 * 5e-3 / SPACING * STIFFNESS * 2.5e-6)
    yield relative_row("yarns", "drawn by 2.5 um", "force [mN]", 1e3 * force, 1e3 * partial, 3.0)
    sine = WAVE / math.hypot(WAVE, SPACING)
    for friction in (0.1, 0.2, 0.3):
        yarn = strand(bending=0.0)
        patch = _one_yarn(12, yarn, friction, 2e7, None)
        net = patch.net
        patch.free[net.grid[0, 1:-1] + net.crossings, 0] = True
        patch.free[net.crossings + net.grid[0, 0], 0] = False
        _drawn(patch, 60, 1e-7)
        rest = np.diff(patch.state[net.slide(net.grid[0]), 0])
        tension = STIFFNESS * (math.hypot(SPACING, WAVE) / rest - 1.0)
        ratios = [second / first for first, second in pairwise(tension)]
        expected = (1.0 + friction * sine) / (1.0 - friction * sine)
        yield relative_row("yarns", f"capstan, mu {friction:g}", "tension ratio", ratios[4], expected, 0.1)


def _held_patch() -> Iterator[ValidationRow]:
    """Draw a waved yarn out of a patch that is held and whose waves may pass from yarn to yarn."""
    net, state = woven_net(PLAIN, np.ones((9, 12), bool), (strand(), strand()), 0.0, 0.0)
    state[: net.crossings] *= 1.01
    free = np.zeros_like(state, dtype=bool)
    free[net.crossings :, 2] = True
    patch = Patch(net, state, free, friction=0.3)
    patch.settle()
    patch.pressed = patch.contact_forces()
    yarn = net.grid[4]
    patch.free[net.crossings + yarn[:-1], 0] = True
    for _ in range(30):
        patch.state[net.crossings + yarn[-1], 0] -= 5e-7
        patch.settle()
    force = -float(patch.reactions()[net.crossings + yarn[-1], 0])
    most = 0.3 * float(patch.contact_forces()[yarn, 0].sum())
    yield relative_row(
        "yarns", "waved, from a held patch", "force at slip [mN]", 1e3 * force, 1e3 * most, 1.0
    )


def _cycle() -> Iterator[ValidationRow]:
    """Draw a yarn out and push it back: what is lost is what friction takes."""
    for friction in (0.3, 0.0):
        patch = _one_yarn(20, strand(wave=0.0), friction, 1e6, 5e-3)
        net = patch.net
        step, end = 5e-8, net.crossings + net.grid[0, -1]
        lost, rubbed, before = 0.0, 0.0, 0.0
        for k in range(160):
            anchors = patch.anchors[:, 0].copy()
            change = step if k < 80 else -step
            patch.state[end, 0] -= change
            patch.settle()
            force = -float(patch.reactions()[end, 0])
            lost += 0.5 * (before + force) * change
            before = force
            rubbed += friction * 5e-3 * float(np.abs(patch.anchors[:, 0] - anchors).sum())
        # What the last equilibrium still stores is not lost.
        held = patch.state[net.crossings :, 0] - patch.anchors[:, 0]
        kept = patch.stored() + 0.5 * patch.grip * float((held**2).sum()) * (friction > 0.0)
        name = f"drawn and pushed back, mu {friction:g}"
        yield absolute_row(
            "yarns", name, "work lost [nJ]", 1e9 * (lost - kept), 1e9 * rubbed, 0.01e9 * rubbed + 1e-6
        )


def _triangles() -> Iterator[ValidationRow]:
    """Let a sheet on four corners sag, as straight yarns and as the engine's triangles."""
    side, count, stiffness, shear, rigidity, density = 0.5, 20, 600.0, 20.0, 2e-5, 0.2
    edge = side / count
    yarn = strand(
        stiffness=stiffness * edge, bending=rigidity * edge, linear_density=density * edge / 2.0, width=1e-6,
        spacing=edge, wave=0.0,
    )  # fmt: skip
    net, state = square(count + 1, yarn, shear=shear)
    corners = net.grid[[0, 0, -1, -1], [0, -1, 0, -1]]
    free = stuck(net, flat=False)
    free[net.crossings :] = False
    free[corners] = False
    patch = Patch(net, state, free, gravity=np.array([0.0, 0.0, -GRAVITY]))
    rest = state[: net.crossings].copy()
    bowl = np.prod(np.sin(np.pi * rest[:, :2] / side), axis=1)
    patch.state[: net.crossings, 2] = -0.01 * side * bowl
    drawn = [side / 2.0 + (rest[corners, :2] - side / 2.0) * (1.0 - 0.01 * k) for k in range(1, 16)]
    for places in drawn:
        patch.state[corners, :2] = places
        patch.settle()
    fabric = Fabric(
        name="sheet", areal_density=density, thickness=1e-4, bending_warp=rigidity, bending_weft=rigidity,
        bending_bias=rigidity, stretch_warp=stiffness, stretch_weft=stiffness, shear=shear, compression=1.0,
    )  # fmt: skip
    quads = np.stack([net.grid[:-1, :-1], net.grid[:-1, 1:], net.grid[1:, 1:], net.grid[1:, :-1]], axis=-1)
    quads = quads.reshape(-1, 4)
    turned = (np.indices((count, count)).sum(axis=0) % 2).ravel() == 1
    quads[turned] = np.roll(quads[turned], 1, axis=1)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    pinned = np.isin(np.arange(net.crossings), corners)
    # The engine's gravity is along -y.
    x = np.column_stack([rest[:, 0], -0.01 * side * bowl, rest[:, 1]])
    for places in drawn:
        x[corners, 0], x[corners, 2] = places.T
        stepper = free_stepper(flat_cloth(rest[:, :2], faces, x, fabric, pinned=pinned), gravity=GRAVITY)
        stepper.step(PULL)
        x = stepper.x.copy()
    apart = patch.state[: net.crossings] - x[:, [0, 2, 1]]
    distance = float(np.sqrt((apart**2).sum(axis=1).mean()))
    yield absolute_row(
        "yarns", "sheet on four corners", "RMS distance to triangles [m]", distance, 0.0, 0.01 * side
    )
