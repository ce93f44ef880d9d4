"""Swatches of woven cloth, pulled, sheared and bent yarn by yarn, in equilibrium: see docs/swatch.md."""
