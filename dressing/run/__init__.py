"""A run: the scene, its settings, progress, checkpoints, report and results."""
