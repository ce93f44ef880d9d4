"""What a report says about a result, in words."""

from typing import Any


def facts_of_report(report: dict[str, Any]) -> dict[str, str]:
    """Return what a report says, in words."""
    try:
        crossings, strain = report["intersections"], report["strain_percent"]
        facts = {
            "state": str(report["status"]).replace("_", " "),
            "garments": ", ".join(f"{one['name']} ({one['fabric']})" for one in report["garments"]),
            "triangles": str(report["faces"]["final"]),
            "crossings": f"{crossings['avatar']} with the body, {crossings['self']} with itself",
            "strain": f"{strain['p99']:.1f} % (99th percentile along the threads)",
        }
        if report["min_gap_mm"] is not None:
            facts["smallest gap"] = f"{report['min_gap_mm']:.2f} mm"
        return facts
    except (LookupError, TypeError, ValueError):
        return {}
