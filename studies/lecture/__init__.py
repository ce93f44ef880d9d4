"""Cloth to learn from: two models or two integrators side by side, and a lecture in eight steps."""
