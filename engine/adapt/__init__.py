"""Adaptive remeshing of a cloth in simulation: sizing fields, gates, transfer to a new mesh."""
