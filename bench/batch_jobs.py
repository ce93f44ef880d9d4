"""Jobs over a data folder: 90 that should converge and 10 that must fail, each for its reason.

python bench/batch_jobs.py DATA OUT [--take 20]
toile batch --jobs OUT/jobs.jsonl --quality preview --job-timeout 900 --job-memory 3 -o OUT/batch
python bench/batch_jobs.py DATA OUT --check

DATA holds patterns/, garments/ and bodies/ with their index.json. The right jobs are its patterns and
garments on the bodies they were made for, and the built-in patterns drafted to other bodies. The names of
wrong jobs begin with `wrong` and the class they must fail with. --take writes so many of the right jobs,
spread over all, and all wrong ones. --check prints the table of the batch and how far it is as expected.
"""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import trimesh
from dress_all import body_file
from dress_all import jobs as data_jobs

from toile.dressing.batch.ledger import rows

RIGHT = 90
OTHERS = "anny_f_apose mh_f_slim_tall mh_m_old mh_child_8 f_smpl_average_A40 anny_child_apose"
BUILT_IN = {
    "tshirt": f"{OTHERS} mh_m_muscular",
    "trousers": f"{OTHERS} mh_f_average",
    "circle_skirt": "anny_f_apose anny_child_apose mh_m_old",
}
"""Built-in patterns, and bodies that they are drafted to."""


def right_jobs(data: Path) -> list[dict[str, Any]]:
    """Jobs that should converge, those of each kind spread over the list."""
    found = [
        {"name": name, "avatar": str(body_file(data, body)), "garment": str(garment)}
        for name, garment, body in data_jobs(data)
    ]
    built_in = [
        {"name": f"{body}__{pattern}", "avatar": str(body_file(data, body)), "garment": pattern}
        for pattern, bodies in BUILT_IN.items()
        for body in bodies.split()
    ]
    step = len(found) / (RIGHT - len(built_in))
    chosen = [found[int(k * step)] for k in range(RIGHT - len(built_in))]
    return [job for _, job in sorted([*spread(chosen), *spread(built_in)], key=lambda pair: pair[0])]


def spread(jobs: list[dict[str, Any]]) -> list[tuple[float, dict[str, Any]]]:
    """Jobs with their places between 0 and 1, evenly."""
    return [((k + 0.5) / len(jobs), job) for k, job in enumerate(jobs)]


def wrong_jobs(data: Path, out: Path) -> list[dict[str, Any]]:
    """Jobs that must fail, with the files at fault."""
    out.mkdir(parents=True, exist_ok=True)
    body = body_file(data, "mean_female")
    shirt = data / "patterns/tshirt__mean_female_specification.json"
    (out / "empty.obj").write_text("")
    (out / "text.ply").write_text("this is no mesh\n")
    (out / "points.obj").write_text("v 0 0 0\nv 0 1.7 0\nv 0.3 1 0\n")
    (out / "nan.obj").write_text("v 0 0 0\nv nan 0 0\nv 0 1.7 0\nf 1 2 3\n")
    (out / "cut_off.json").write_text(shirt.read_text()[:2000])
    far = trimesh.creation.cylinder(radius=0.3, height=0.5, sections=24)
    far.apply_translation((5.0, 1.0, 0.0))
    far.export(out / "far_away.obj", include_normals=False)
    on_body = {"avatar": str(body), "garment": str(shirt)}
    man, sitter = (str(body_file(data, name)) for name in ("mh_m_heavy", "anny_m_sit"))
    unknown = {"source": str(shirt), "pins": ["no_such_label"]}
    child = data / "patterns/shorts__mh_child_8_specification.json"
    wrong = [
        ("bad_input", "missing_body", {**on_body, "avatar": str(out / "nowhere.obj")}),
        ("bad_input", "empty_body", {**on_body, "avatar": str(out / "empty.obj")}),
        ("bad_input", "text_as_body", {**on_body, "avatar": str(out / "text.ply")}),
        ("bad_input", "points_as_body", {**on_body, "avatar": str(out / "points.obj")}),
        ("bad_input", "nan_in_body", {**on_body, "avatar": str(out / "nan.obj")}),
        ("bad_input", "cut_off_pattern", {**on_body, "garment": str(out / "cut_off.json")}),
        ("bad_input", "far_away", {**on_body, "garment": str(out / "far_away.obj")}),
        ("bad_input", "sitting_body", {"avatar": sitter, "garment": "trousers"}),
        ("bad_input", "unknown_label", {**on_body, "garment": [unknown]}),
        ("open_seams", "child_shorts_on_a_man", {"avatar": man, "garment": str(child)}),
    ]  # fmt: skip
    return [{"name": f"wrong_{kind}__{what}", **job} for kind, what, job in wrong]


def check(out: Path) -> int:
    """Print the batch's table and how far it is as expected."""
    table = list(rows(out / "batch"))
    print("| job | ended | class | crossings | CPU s | peak MB | message |\n|---|---|---|---|---|---|---|")
    for row in table:
        cells = [
            row["name"],
            row["status"] or row["state"],
            row["failure_class"],
            "" if row["status"] is None else row["worst_frame_intersections"],
            f"{row['cpu_seconds'] or 0.0:.1f}",
            round((row["peak_memory"] or 0) / 1e6),
            row["message"],
        ]
        print(f"| {' | '.join(str(cell) for cell in cells)} |".replace(f"{out}/", ""))
    right = [row for row in table if not row["name"].startswith("wrong")]
    wrong = [row for row in table if row["name"].startswith("wrong")]
    good = sum(row["status"] == "converged" and row["worst_frame_intersections"] == 0 for row in right)
    expected = sum(row["name"].startswith(f"wrong_{row['failure_class']}__") for row in wrong)
    silent = [row["name"] for row in table if row["state"] == "failed" and not row["message"]]
    seconds = sum(row["cpu_seconds"] or 0.0 for row in right)
    print(
        f"\n{good} of {len(right)} right jobs converged, no crossing in any output frame; {seconds:.0f} CPU s"
    )
    print(f"{expected} of {len(wrong)} wrong jobs failed with the right class; no reason: {silent or 'none'}")
    return 0 if good >= 0.95 * len(right) and expected == len(wrong) and not silent else 1


def main() -> int:
    """Write the jobs file, or check the batch."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--take", type=int, default=RIGHT)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if options.check:
        return check(options.out)
    data, out = options.data.resolve(), options.out.resolve()
    right = right_jobs(data)
    chosen = [right[int(k * len(right) / options.take)] for k in range(options.take)]
    jobs = [*chosen, *wrong_jobs(data, out / "wrong")]
    (out / "jobs.jsonl").write_text("".join(json.dumps(job) + "\n" for job in jobs))
    print(f"wrote {out / 'jobs.jsonl'}: {len(jobs)} jobs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
