"""Adaptation of a cloth mesh to a sizing field by splits, flips and collapses; transfer of its data."""
