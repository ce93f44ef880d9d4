"""Dress every pattern and every single-layer garment of a data folder on its body, and store the table.

python bench/dress_all.py DATA OUT [--quality preview] [--only NAME ...] [--timeout 900] [--resume]
    [--part 1/2]

DATA holds patterns/, garments/ and bodies/ with their index.json. One process per garment, one after the
other; OUT gets one folder per garment (picture, meshes, report) and table.json, table.md. With --resume,
garments that have a report in OUT already are not dressed again. With --part k/n, only every n-th garment is
dressed, from the k-th on: n processes share the work, and a last run with --resume writes the whole table.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

BODY_OF_UPSTREAM = {
    "shirt_mean": "mean_all",
    "hoody_mean": "mean_all",
    "js_mean_all": "mean_all",
    "dress_pencil": "mean_female",
}


def jobs(data: Path) -> list[tuple[str, Path, str]]:
    """(name, garment file, body) of everything that is to be dressed."""
    found = []
    rows = {row["name"]: row for row in json.loads((data / "patterns/index.json").read_text())}
    for path in sorted((data / "patterns").glob("*_specification.json")):
        name = path.name.removesuffix("_specification.json")
        row = rows.get(name, {})
        body = BODY_OF_UPSTREAM.get(name) or row["body"]
        # The data's README: trousers drafted on mean_all belong on the body whose legs stand apart.
        if body == "mean_all" and (row.get("bottom") == "Pants" or name.startswith("js_")):
            body = "mean_all_apart"
        found.append((name, path, body))
    for path in sorted((data / "garments").glob("*.obj")):
        found.append((path.stem, path, path.stem.split("__")[1]))
    return found


def body_file(data: Path, body: str) -> Path:
    """The file of a body."""
    ply = data / f"bodies/{body}.ply"
    return ply if ply.exists() else data / f"bodies/{body}.obj"


def dress(
    name: str, garment: Path, body: Path, out: Path, quality: str, timeout: float, resume: bool
) -> dict[str, Any]:
    """Run one job in a process of its own; return its row."""
    started = time.perf_counter()
    command = [
        sys.executable, "-m", "toile", "dress", "--avatar", str(body), "--garment", str(garment),
        "--quality", quality, "--quiet", "-o", str(out / name),
    ]  # fmt: skip
    row: dict[str, Any] = {"name": name, "body": body.stem, "quality": quality, "message": ""}
    report = out / name / "report.json"
    finished = resume and report.exists()
    if not finished:
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
            finished = done.returncode in (0, 3) and report.exists()
            row["message"] = (done.stderr.strip().splitlines() or [""])[-1]
        except subprocess.TimeoutExpired:
            row["message"] = f"stopped after {timeout:g} s"
    row["wall_seconds"] = round(time.perf_counter() - started, 1)
    if finished:
        facts = json.loads(report.read_text())
        row |= {
            "status": facts["status"],
            "failure": facts["failure"],
            "avatar": facts["intersections"]["avatar"],
            "self": facts["intersections"]["self"],
            "worst_frame": facts["intersections"]["worst_frame"],
            "nodes": facts["nodes"]["final"],
            "steps": facts["steps"],
            "cpu_seconds": round(facts["cpu_seconds"], 1),
            "min_gap_mm": facts["min_gap_mm"],
            "strain_p99": round(facts["strain_percent"]["p99"], 2),
        }
    else:
        row["status"] = "error"
    return row


def table(rows: list[dict[str, Any]]) -> str:
    """Markdown table of all rows, and the counts."""
    lines = [
        "| garment | body | status | avatar | self | worst frame | nodes | steps | CPU s | reason |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        failure = row.get("failure") or {}
        reason = f"{failure.get('class', '')}: {failure.get('message', '')}" if failure else ""
        if row["status"] == "error":
            reason = row["message"]
        lines.append(
            f"| {row['name']} | {row['body']} | {row['status']} "
            f"| {row.get('avatar', '')} | {row.get('self', '')} | {row.get('worst_frame', '')} "
            f"| {row.get('nodes', '')} | {row.get('steps', '')} "
            f"| {row.get('cpu_seconds', '')} | {reason} |"
        )
    count = len(rows)
    converged = sum(row["status"] == "converged" for row in rows)
    clean = sum(row.get("worst_frame") == 0 for row in rows)
    lines += [
        "",
        f"{converged} of {count} converged; {clean} of {count} without a crossing in any output frame.",
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--quality", default="preview")
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--timeout", type=float, default=900.0)
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--part", default="1/1")
    options = parser.parse_args()
    first, parts = (int(number) for number in options.part.split("/"))
    options.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for name, garment, body in jobs(options.data)[first - 1 :: parts]:
        if options.only and not any(part in name for part in options.only):
            continue
        row = dress(
            name, garment, body_file(options.data, body), options.out, options.quality, options.timeout,
            options.resume,
        )  # fmt: skip
        rows.append(row)
        reason = row.get("failure") or (row["message"] if row["status"] == "error" else "")
        print(
            f"{row['name']:45s} {row['status']:12s} {row.get('avatar')}/{row.get('self')} "
            f"worst {row.get('worst_frame')} cpu {row.get('cpu_seconds')} {reason}",
            flush=True,
        )
        (options.out / "table.json").write_text(json.dumps(rows, indent=1))
        (options.out / "table.md").write_text(table(rows))
    print(table(rows).splitlines()[-1])
    return 0 if all(row["status"] == "converged" for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
