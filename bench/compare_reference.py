"""Compare our drapes of the two reference patterns with those of another solver, garment by garment.

python bench/compare_reference.py DATA OURS

DATA/reference holds tee_sim.obj, skirt_sim.obj and their body; OURS/ref_tee and OURS/ref_skirt are output
folders of `toile dress` for the same patterns and body.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial import cKDTree

SAMPLES = 1_500_000


def strains(positions: np.ndarray, faces: np.ndarray, uv: np.ndarray, uv_faces: np.ndarray) -> np.ndarray:
    """Edge strain of every face's sides, shape (3 t,)."""
    three = [positions[faces[:, k]] - positions[faces[:, (k + 1) % 3]] for k in range(3)]
    flat = [uv[uv_faces[:, k]] - uv[uv_faces[:, (k + 1) % 3]] for k in range(3)]
    lengths = [np.linalg.norm(side, axis=1) for side in three]
    rest = [np.linalg.norm(side, axis=1) for side in flat]
    return np.concatenate(lengths) / np.maximum(np.concatenate(rest), 1e-9) - 1.0


def read_obj(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Positions, faces, texture coordinates and texture faces of a triangle OBJ."""
    v, vt, f, ft = [], [], [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            v.append([float(word) for word in words[1:4]])
        elif words[0] == "vt":
            vt.append([float(word) for word in words[1:3]])
        elif words[0] == "f":
            corners = [word.split("/") for word in words[1:]]
            for k in range(1, len(corners) - 1):
                f.append([int(corners[i][0]) - 1 for i in (0, k, k + 1)])
                ft.append([int(corners[i][1]) - 1 for i in (0, k, k + 1)])
    return np.array(v), np.array(f), np.array(vt), np.array(ft)


def main() -> int:
    """Print the comparison as a Markdown table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("ours", type=Path)
    options = parser.parse_args()
    body = trimesh.load(options.data / "reference/f_smpl_template.ply", process=False)
    surface = cKDTree(trimesh.sample.sample_surface(body, SAMPLES, seed=0)[0])
    print("| drape | vertices | gap median / p5 mm | strain median / p5 / p95 / p99 % | lowest m | width m |")
    print("|---|---|---|---|---|---|")
    for name in ("tee", "skirt"):
        for label, path in (
            (f"{name}, other solver", options.data / f"reference/{name}_sim.obj"),
            (f"{name}, toile", options.ours / f"ref_{name}/{name}.obj"),
        ):
            positions, faces, uv, uv_faces = read_obj(path)
            gap = 1e3 * surface.query(positions)[0]
            strain = 100.0 * strains(positions, faces, uv, uv_faces)
            quantiles = " / ".join(f"{value:+.1f}" for value in np.quantile(strain, [0.5, 0.05, 0.95, 0.99]))
            print(
                f"| {label} | {len(positions)} | {np.median(gap):.1f} / {np.quantile(gap, 0.05):.1f} "
                f"| {quantiles} "
                f"| {positions[:, 1].min():.3f} | {np.ptp(positions[:, 0]):.3f} |"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
