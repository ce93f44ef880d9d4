"""Cloth in motion: the film loop, its step sizes and time-stepping methods."""
