"""Meshing: an outline or a mesh in, a better mesh out."""
