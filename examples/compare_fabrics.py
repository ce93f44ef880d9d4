"""Silk, jersey and denim over the same disc: how much shadow a round cloth still casts tells its drape.

This is Cusick's drape test; textile laboratories measure it. Run: python examples/compare_fabrics.py [FOLDER]
"""

import json
import sys
from pathlib import Path

import toile
from toile.engine.cloth.cloth import Cloth
from toile.studies.validation.cusick import drape_coefficient, hung

NAMES = ("silk-charmeuse", "cotton-interlock", "denim-12oz")


def main(output: str = "out", edge: float = 0.01) -> dict[str, Cloth]:
    """Hang a cloth of each fabric, 30 cm across, over a disc of 18 cm; write their drape coefficients [%]."""
    cloths, coefficients = {}, {}
    for name in NAMES:
        cloth, _ = hung(toile.fabric(name), edge)
        cloths[name], coefficients[name] = cloth, 100.0 * drape_coefficient(cloth)
        print(f"{name}: drape coefficient {coefficients[name]:.0f} %")
    Path(output).mkdir(parents=True, exist_ok=True)
    (Path(output) / "drape.json").write_text(json.dumps(coefficients, indent=1))
    return cloths


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "out")
