"""Fabric from yarn: what a weave weighs, how it stretches, bends and locks."""
