"""Adaptive against uniform meshes: error for time, distances between surfaces."""
