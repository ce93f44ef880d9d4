"""Load kernels; on a first run, compile them in two processes at once."""

import os
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

DRAPE_KERNELS = (
    "toile.engine.forces.membrane",
    "toile.engine.solve.assembly",
    "toile.engine.solve.block_pattern",
    "toile.engine.solve.linear_system",
    "toile.engine.solve.cg",
    "toile.engine.solve.preconditioner.block_jacobi",
    "toile.engine.solve.preconditioner.gauss_seidel",
    "toile.collide.guard",
    "toile.collide.carry",
    "toile.engine.forces.contact",
    "toile.engine.forces.friction",
    "toile.engine.solve.preconditioner.aggregates",
    "toile.engine.solve.preconditioner.band_cholesky",
    "toile.engine.solve.preconditioner.rigid_coarse",
    "toile.engine.solve.preconditioner.rigid_product",
    "toile.engine.solve.preconditioner.rigid_transfer",
    "toile.collide.bvh",
    "toile.collide.candidates",
    "toile.collide.cover",
    "toile.collide.merged_pairs",
    "toile.collide.segment_hits",
    "toile.collide.search",
    "toile.collide.shrunken",
    "toile.geometry.slope_stencil",
)
PANEL_KERNELS = (
    "toile.remesh.panel.smooth_points",
    "toile.remesh.panel.split_ears",
    "toile.remesh.panel.delaunay_flip",
    "toile.remesh.panel.frontal_insert",
)
REMESH_KERNELS = (
    "toile.collide.patch_clearance",
    "toile.remesh.sizing.edge_size",
    "toile.remesh.adapt.choose_merges",
    "toile.remesh.sizing.smooth_curvature",
    "toile.remesh.mesh.mesh_edges",
    "toile.remesh.adapt.mesh_in_work",
    "toile.remesh.adapt.judge_flips",
    "toile.remesh.adapt.flip_round",
    "toile.remesh.adapt.removable_nodes",
    "toile.remesh.mesh.node_faces",
    "toile.remesh.adapt.merge_patches",
    "toile.remesh.adapt.disjoint_pairs",
)
INTEGRATOR_KERNELS = ("toile.engine.forces.spring", "toile.engine.forces.membrane_damping")
PICTURE_KERNELS = ("toile.dressing.pictures.rasterizer", "toile.dressing.pictures.shading")
"""Modules that hold kernels, those that others import before those."""

IMPORT_ALL = "import importlib, sys; [importlib.import_module(name) for name in sys.argv[1:]]"


def load_kernels(modules: Sequence[str]) -> None:
    """Import modules that hold kernels: what no earlier run has compiled is compiled, and stored on disk.

    Where nothing is stored yet, a second process works through the list from its end; what it has stored
    when this one gets there is loaded. Without it, or if it fails, this process compiles everything.
    """
    from toile.geometry.kernel import WARM

    helper = None if WARM else start_helper(modules[::-1])
    try:
        for name in modules:
            import_module(name)
    finally:
        if helper is not None:
            helper.kill()
            helper.wait()


def start_helper(modules: Sequence[str]) -> subprocess.Popen[bytes] | None:
    """Start a process that compiles the kernels of these modules; None where that is of no use."""
    # A program that embeds Python may name itself as the executable.
    if (os.cpu_count() or 1) < 2 or "python" not in Path(sys.executable or "").name.lower():
        return None
    environment = module_path_environment()
    command = [sys.executable, "-P", "-c", IMPORT_ALL, *modules]
    try:
        return subprocess.Popen(
            command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip
    except (OSError, ValueError):
        return None


def module_path_environment() -> dict[str, str]:
    """Return the environment of a Python process that finds the same modules as this one."""
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
