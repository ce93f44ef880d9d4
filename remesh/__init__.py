"""Mesh in, better mesh out."""
