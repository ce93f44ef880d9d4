"""A batch: bodies of several heights, each job in a process of its own, and a table of the outcomes.

`toile batch status FOLDER` shows the table again; `toile batch gallery FOLDER` makes pages to look through.
Run: python examples/batch.py [FOLDER]
"""

import sys
from collections.abc import Iterator, Sequence

import toile

HEIGHTS = (1.50, 1.65, 1.80)


def jobs(heights: Sequence[float], edge_length: float | None) -> Iterator[toile.Job]:
    """Yield one job per height; they may be millions, as they are taken when there is room."""
    for height in heights:
        scene = toile.Scene(
            avatar=toile.MannequinSize(height=height),
            garments=[toile.Garment("tshirt", fabric="cotton-interlock")],
            quality="preview",
            edge_length=edge_length,
        )
        yield toile.Job(f"shirt-{100 * height:.0f}", scene)


def main(
    output: str = "out", heights: Sequence[float] = HEIGHTS, edge_length: float | None = None
) -> list[toile.JobResult]:
    """Dress them all; the same call again leaves alone what is done."""
    results = []
    for result in toile.batch(jobs(heights, edge_length), output, job_timeout=900):
        print(result.name, result.outcome.state, result.outcome.message, result.folder)
        results.append(result)
    return results


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
