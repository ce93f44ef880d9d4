"""CPU time and iterations of the linear solver on cloth as the implicit step meets it.

Run: python bench/linear_solver.py [--nodes 2000 8000] [--layers 1] [--out results.json] [--product]

`--product` compares the product of the matrix and a vector with the bandwidth of memory instead: the time in
which a triad a = b + s c (McCalpin 1995) moves as many bytes, in the same run. `ratio` is to one from main
memory (arrays that no cache holds), `ratio_in_cache` to one over arrays that take as much room as the matrix.
"""

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numba import types
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.spatial import Delaunay, cKDTree

from toile.engine.solve.assembly import scatter_hessians
from toile.engine.solve.block_pattern import BlockPattern
from toile.engine.solve.cg import solve
from toile.engine.solve.linear_system import ContactStencils, LinearSystem
from toile.engine.solve.preconditioner.base import Preconditioner
from toile.engine.solve.preconditioner.block_jacobi import BlockJacobi
from toile.engine.solve.preconditioner.gauss_seidel import SymmetricGaussSeidel
from toile.engine.solve.preconditioner.two_level import TwoLevel
from toile.geometry.kernel import F64_1, OUT_F64_1, kernel

EDGE = 0.01
LARGE = 384_000_000
"""Bytes of a triad's three arrays that no cache of this decade's processors holds."""
STRETCH, SHEAR, DENSITY, BENDING, SEAM, CONTACT = 3000.0, 90.0, 0.15, 1e-5, 5e3, 50.0


def flat_panel(count: int, seed: int):
    """Random points in a rectangle 1 : 1.3, spaced EDGE, with regular borders; the left and right match."""
    rng = np.random.default_rng(seed)
    spacing = EDGE * (3**0.25 / 2**0.5)
    columns = max(4, round((count / 1.3) ** 0.5))
    rows = count // columns
    u, v = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    shift = np.where(v % 2 == 1, 0.25, -0.25) * ((u > 0) & (u < columns - 1))
    jitter = rng.uniform(-0.3, 0.3, (2, columns, rows))
    inside = (u > 0) & (u < columns - 1) & (v > 0) & (v < rows - 1)
    plane = np.stack([u + shift + jitter[0] * inside, v + jitter[1] * inside], axis=-1).reshape(-1, 2)
    triangles = Delaunay(plane).simplices.astype(np.int32)
    a, b, c = plane[triangles[:, 0]], plane[triangles[:, 1]], plane[triangles[:, 2]]
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    keep = np.abs(area) > 0.05
    triangles[area < 0] = triangles[area < 0][:, ::-1]
    triangles = np.ascontiguousarray(triangles[keep])
    left = np.arange(rows)
    seam = np.column_stack([left, left + (columns - 1) * rows]).astype(np.int32)
    return 2**0.5 * spacing * plane, triangles, seam


def tube(plane, radius_offset: float):
    """Roll a panel into a hanging tube with vertical folds."""
    width = plane[:, 0].max()
    angle = 2 * np.pi * plane[:, 0] / width * 0.985
    down = plane[:, 1] / plane[:, 1].max()
    radius = width / (2 * np.pi) * (1 + 0.12 * down * np.sin(9 * angle + 3 * down)) + radius_offset
    radius += 0.004 * np.sin(70 * plane[:, 0] + 20 * plane[:, 1]) * np.sin(60 * plane[:, 1])
    return np.column_stack([radius * np.sin(angle), -plane[:, 1], radius * np.cos(angle)])


class GarmentProblem:
    """Stiff woven tube(s), Baraff-Witkin membrane, quadratic bending, a half closed seam, body contact."""

    def __init__(self, count: int, *, layers: int = 1, strain: float = 0.005, seed: int = 1) -> None:
        rng = np.random.default_rng(seed)
        panels = [flat_panel(count // layers, seed + k) for k in range(layers)]
        offsets = np.cumsum([0] + [len(p[0]) for p in panels])
        self.positions = np.concatenate([tube(p[0], 0.003 * k) for k, p in enumerate(panels)])
        triangles = np.concatenate([p[1] + o for p, o in zip(panels, offsets, strict=False)]).astype(np.int32)
        plane = np.concatenate([p[0] for p in panels])
        seam = np.concatenate([p[2] + o for p, o in zip(panels, offsets, strict=False)]).astype(np.int32)
        # nodes of a real garment arrive in the order of a mesher, not of a grid
        order = rng.permutation(len(plane))
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        plane, self.positions = plane[order], np.ascontiguousarray(self.positions[order])
        self.triangles = rank[triangles].astype(np.int32)
        self.seam = rank[seam].astype(np.int32)
        self.plane = plane
        self.count = len(plane)
        self.pattern = BlockPattern(self.count, [self.triangles, self.seam])
        self.blocks = self.pattern.zeros()
        self.right_hand_side = np.zeros((self.count, 3))
        self._membrane(strain)
        self._seam()
        self._bending()
        self._contact(layers, offsets, rank)
        self.pinned = self.positions[:, 1] > -0.5 * EDGE
        self.system = LinearSystem(self.pattern, self.bending)

    def _membrane(self, strain: float) -> None:
        x, t, plane = self.positions, self.triangles, self.plane
        e1, e2 = x[t[:, 1]] - x[t[:, 0]], x[t[:, 2]] - x[t[:, 0]]
        d1, d2 = plane[t[:, 1]] - plane[t[:, 0]], plane[t[:, 2]] - plane[t[:, 0]]
        normal = np.cross(e1, e2)
        self.area = 0.5 * np.linalg.norm(normal, axis=1)
        normal /= 2 * self.area[:, None]
        det = d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]
        warp = (e1 * d2[:, 1:2] - e2 * d1[:, 1:2]) / det[:, None]
        warp /= np.linalg.norm(warp, axis=1)[:, None]
        weft = np.cross(normal, warp)
        rest = np.stack([np.stack([(e * warp).sum(1), (e * weft).sum(1)], axis=1) for e in (e1, e2)], axis=2)
        inverse = np.linalg.inv(rest)
        centre = plane[t].mean(axis=1)
        stretch = 1 + strain * np.stack(
            [np.sin(31 * centre[:, 0] + 11 * centre[:, 1]), np.cos(17 * centre[:, 0] - 29 * centre[:, 1])], 1
        )
        fu, fv = warp * stretch[:, :1], weft * stretch[:, 1:]
        fu = fu + 0.3 * strain * weft
        weights = np.stack([-inverse[:, 0] - inverse[:, 1], inverse[:, 0], inverse[:, 1]], axis=1)
        eye = np.eye(3)

        def stretch_hessian(f):
            length = np.linalg.norm(f, axis=1)
            unit = f / length[:, None]
            outer = unit[:, :, None] * unit[:, None, :]
            across = np.maximum(0, 1 - 1 / length)[:, None, None]
            gradient = STRETCH * (length - 1)[:, None] * unit
            return STRETCH * (outer + across * (eye - outer)), gradient

        huu, gu = stretch_hessian(fu)
        hvv, gv = stretch_hessian(fv)
        skew = (fu * fv).sum(1)[:, None]
        gu, gv = gu + SHEAR * skew * fv, gv + SHEAR * skew * fu
        huu = huu + SHEAR * fv[:, :, None] * fv[:, None, :]
        hvv = hvv + SHEAR * fu[:, :, None] * fu[:, None, :]
        huv = SHEAR * fv[:, :, None] * fu[:, None, :]
        hessians = np.zeros((len(t), 6, 3, 3))
        for p, (a, b) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]):
            ua, va, ub, vb = (weights[:, k, m][:, None, None] for k, m in ((a, 0), (a, 1), (b, 0), (b, 1)))
            hessians[:, p] = self.area[:, None, None] * (
                ua * ub * huu + ua * vb * huv + va * ub * huv.transpose(0, 2, 1) + va * vb * hvv
            )
        scatter_hessians(self.pattern.slots[0], hessians, self.blocks)
        self.mass = np.zeros(self.count)
        np.add.at(self.mass, t, DENSITY * self.area[:, None] / 3)
        for a in range(3):
            g = self.area[:, None] * (weights[:, a, :1] * gu + weights[:, a, 1:] * gv)
            np.add.at(self.right_hand_side, t[:, a], -g)
        self.right_hand_side[:, 1] -= 9.81 * self.mass

    def _seam(self) -> None:
        d = self.positions[self.seam[:, 1]] - self.positions[self.seam[:, 0]]
        k = np.tile(SEAM * EDGE * np.eye(3), (len(d), 1, 1))
        scatter_hessians(
            self.pattern.slots[1], np.ascontiguousarray(np.stack([k, k, -k], axis=1)), self.blocks
        )
        np.add.at(self.right_hand_side, self.seam[:, 0], SEAM * EDGE * d)
        np.add.at(self.right_hand_side, self.seam[:, 1], -SEAM * EDGE * d)

    def _bending(self) -> None:
        x, t = self.positions, self.triangles
        rows, columns, values = [], [], []
        for a in range(3):
            i, j, k = t[:, a], t[:, (a + 1) % 3], t[:, (a + 2) % 3]
            p, q = x[i] - x[k], x[j] - x[k]
            cotangent = 0.5 * (p * q).sum(1) / np.linalg.norm(np.cross(p, q), axis=1)
            rows += [i, j, i, j]
            columns += [j, i, i, j]
            values += [-cotangent, -cotangent, cotangent, cotangent]
        shape = (self.count, self.count)
        laplacian = coo_array(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape
        )
        laplacian = laplacian.tocsr()
        self.bending = csr_array(laplacian.T @ diags_array(DENSITY / self.mass) @ laplacian)

    def _contact(self, layers: int, offsets, rank) -> None:
        radial = self.positions * [1, 0, 1]
        radial /= np.linalg.norm(radial, axis=1)[:, None]
        inner = np.zeros(self.count, bool)
        inner[rank[: offsets[1]]] = True
        touching = np.flatnonzero(inner & (np.sin(5 * self.positions[:, 1] * 6) > 0))
        nodes = np.full((len(touching), 4), -1, np.int32)
        nodes[:, 0] = touching
        weights = np.tile([1.0, 0, 0, 0], (len(touching), 1))
        normals = radial[touching]
        if layers > 1:
            outer = np.flatnonzero(~inner)
            triangles = self.triangles[inner[self.triangles].all(axis=1)]
            near = cKDTree(self.positions[triangles].mean(axis=1)).query(self.positions[outer])[1]
            pick = np.cos(40 * self.positions[outer, 1]) > -0.3
            more = np.column_stack([outer, triangles[near]])[pick].astype(np.int32)
            nodes = np.concatenate([nodes, more])
            weights = np.concatenate([weights, np.tile([1.0, -0.4, -0.3, -0.3], (len(more), 1))])
            normals = np.concatenate([normals, radial[outer][pick]])
        # the tangential part is friction
        outer_product = normals[:, :, None] * normals[:, None, :]
        stiffness = CONTACT * outer_product + 0.02 * CONTACT * (np.eye(3) - outer_product)
        self.contacts = ContactStencils(np.ascontiguousarray(nodes), weights, stiffness)

    def update(self, step: float) -> None:
        self.system.update(
            self.blocks,
            self.mass / step**2,
            bending_scale=BENDING,
            contacts=self.contacts,
            pinned=self.pinned,
        )


METHODS: dict[str, Callable[[LinearSystem], Preconditioner]] = {
    "block Jacobi": lambda system: BlockJacobi(),
    "Gauss-Seidel": lambda system: SymmetricGaussSeidel(system.pattern),
    "two-level 30": lambda system: TwoLevel(system, group_size=30),
    "two-level 60": lambda system: TwoLevel(system, group_size=60),
    "two-level 120": lambda system: TwoLevel(system, group_size=120),
}


def cpu_milliseconds(call: Callable[[], object], repeats: int = 3) -> float:
    """Least CPU time of a few calls: the others were disturbed."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return 1e3 * min(times)


@kernel(types.void(F64_1, F64_1, types.float64, OUT_F64_1))
def triad(b, c, factor, a):
    for i in range(a.shape[0]):
        a[i] = b[i] + factor * c[i]


def product_bytes(system: LinearSystem) -> int:
    """Bytes that a product must read and write, every number once."""
    pattern = system.pattern
    arrays = (
        system.blocks, pattern.lower_ranks, pattern.lower_indptr, system.outer_values,
        system.outer_ranks, system.outer_indptr, system.pinned,
    )  # fmt: skip
    return sum(array.nbytes for array in arrays) + 2 * 24 * system.pattern.node_count


def triad_milliseconds(room: int, repeats: int) -> float:
    """CPU time of a triad whose arrays take so many bytes."""
    a, b, c = (np.full(room // 24, value) for value in (0.0, 1.0, 2.0))
    return cpu_milliseconds(lambda: [triad(b, c, 0.5, a) for _ in range(repeats)], 7) / repeats


def measure_product(problem: GarmentProblem) -> dict[str, object]:
    """CPU time of A x against that of triads of as many bytes, milliseconds."""
    problem.contacts = ContactStencils(*(array[:0] for array in problem.contacts))
    problem.update(0.02)
    system = problem.system
    moved = product_bytes(system)
    x, product = problem.right_hand_side.copy(), np.zeros((problem.count, 3))
    repeats = max(3, 100_000_000 // moved)
    floor = triad_milliseconds(LARGE, 1) * moved / LARGE
    in_cache = triad_milliseconds(moved, repeats)
    spent = cpu_milliseconds(lambda: [system.apply(x, product) for _ in range(repeats)], 7) / repeats
    row: dict[str, object] = {
        "nodes": problem.count,
        "MB": round(1e-6 * moved, 2),
        "product_ms": round(spent, 4),
        "memory_GB_per_s": round(1e-6 * moved / floor, 1),
        "ratio": round(spent / floor, 2),
        "cache_GB_per_s": round(1e-6 * moved / in_cache, 1),
        "ratio_in_cache": round(spent / in_cache, 2),
    }
    print(*row.items(), sep="\t", flush=True)
    return row


def measure(problem: GarmentProblem, step: float, tolerances: list[float]) -> list[dict[str, object]]:
    """Every method at every tolerance on one system."""
    problem.update(step)
    system, load = problem.system, problem.right_hand_side
    rows: list[dict[str, object]] = []
    for name, make in METHODS.items():
        made = make(system)
        topology = cpu_milliseconds(lambda make=make: make(system), 1)
        update = cpu_milliseconds(lambda made=made: made.update(system, problem.positions))
        for tolerance in tolerances:
            settings = {"tolerance": tolerance, "max_iterations": 5000}
            result = solve(system, load, made, **settings)
            iterate = cpu_milliseconds(
                lambda made=made, settings=settings: solve(system, load, made, **settings)
            )
            row = {
                "method": name,
                "nodes": problem.count,
                "step_seconds": step,
                "distant_contacts": len(system.contacts.nodes),
                "tolerance": tolerance,
                "iterations": result.iterations,
                "topology_ms": round(topology, 2),
                "update_ms": round(update, 2),
                "solve_ms": round(update + iterate, 2),
            }
            rows.append(row)
            print(*row.values(), sep="\t", flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, nargs="+", default=[300, 2000, 8000])
    parser.add_argument("--steps", type=float, nargs="+", default=[0.005, 0.02, 0.1])
    parser.add_argument("--layers", type=int, default=1)
    parser.add_argument("--strain", type=float, default=0.005)
    parser.add_argument("--product", action="store_true", help="product against memory bandwidth only")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    rows = []
    for nodes in options.nodes:
        problem = GarmentProblem(nodes, layers=options.layers, strain=options.strain)
        for step in [] if options.product else options.steps:
            rows += measure(problem, step, [1e-2, 1e-3, 1e-6])
        if options.product:
            rows.append(measure_product(problem))
    if options.out:
        options.out.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
