"""Motions that lead from a pose of rest into a clip."""
