"""The page and the picture of what bench/integrators.py has measured."""

from pathlib import Path


def table(rows: list[dict[str, object]]) -> str:
    head = list(dict.fromkeys(key for row in rows for key in row))
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += [
        "| " + " | ".join("" if row.get(key) is None else str(row[key]) for key in head) + " |"
        for row in rows
    ]
    return "\n".join(lines)


def draw(facts: dict[str, object], names: list[str], cells: int, path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(15, 4.6), sharey=True)
    panels = [
        (f"mass-spring cloth, 31 x 31, floor {1e3 * facts['floors']['mass-spring']:.2g} mm", "mass-spring"),
        (f"triangle cloth, 31 x 31, floor {1e3 * facts['floors']['triangles']:.2g} mm", "triangles"),
        (f"swing, {cells} x {cells} cells, floor {1e3 * facts['swing_floor']:.2g} mm", "swing"),
    ]
    colours = dict(zip(names, plt.get_cmap("tab10").colors, strict=False))
    for axis, (title, key) in zip(axes, panels, strict=True):
        rows = facts["swing"] if key == "swing" else [r for r in facts["models"] if r["model"] == key]
        for name in names:
            for adaptive in (False, True):
                own = [
                    row
                    for row in rows
                    if row["integrator"] == name
                    and "cpu_s" in row
                    and ("error" in row["steps of"]) == adaptive
                ]
                if own:
                    axis.loglog(
                        [row["cpu_s"] for row in own], [1e3 * row["rms_m"] for row in own],
                        "s--" if adaptive else "o-", color=colours[name], markersize=4,
                        label=f"{name}, sizes by error" if adaptive else name,
                    )  # fmt: skip
        axis.axhline(10.0, color="grey", linewidth=0.8, linestyle=":")
        axis.set_title(title, fontsize=10)
        axis.set_xlabel("CPU s per simulated second")
        axis.grid(True, which="major", linewidth=0.3)
    axes[0].set_ylabel("RMS distance to the converged solution [mm]")
    axes[2].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def page(facts: dict[str, object], cells: int, swing_energy: float, longest: float) -> str:
    said = ", ".join(f"{name} {version}" for name, version in facts["versions"].items())
    floors = facts["floors"]
    return f"""# Integrators

`python bench/integrators.py --out bench/results --picture docs/images/integrators.png`: {said};
{facts["cpu"]}, one core.

Cotton poplin in a vacuum, no contact, no damping. CPU times are single runs for 961 particles, medians of
three for `swing`, matrices and preconditioners built anew in each run; errors are root mean square distances
after 1 s to symplectic Euler in steps of 1/80000 s (quick: 1/20000 s). Energy lost: share of the
{swing_energy:.2f} J that the sheet gains by falling from level to hanging straight; negative: gained.

## Order and damping

Spring pendulum, and a swing of 1 Hz in steps of 1/60 s.

{table(facts["analytic"])}

## 961 particles, every model and integrator

Halving the steps of the reference moves it by {1e3 * floors["mass-spring"]:.2g} mm (mass-spring) and {
        1e3 * floors["triangles"]:.1f} mm (triangles). Largest stable step: the longest of {
        longest
    } s (explicit: 1/2000 s)
divided by powers of 1.25 with which the energy rises by less than 1 % of the swing's; 0: none down to 1/36000
s.

{table(facts["models"])}

## `swing`, {cells} x {cells} cells, triangles

Halving the steps of the reference moves it by {1e3 * facts["swing_floor"]:.1f} mm.

{table(facts["swing"])}

CPU s at equal error, between rows of equal steps (empty: not bracketed):

{table(facts["equal_error"])}

## One Newton step

{table([facts["newton"]])}
"""
