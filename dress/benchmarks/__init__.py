"""Scenes that benchmarks measure and compare."""
