"""Woven cloth at the level of its yarns, in equilibrium: a patch of crossings, without masses, without time.

Nothing else in toile is built on it. Simulation of cloth by crossings that carry two sliding coordinates,
moved in time with masses along the yarns, is claimed in US 10,528,683 B2 and US 11,250,187 B2 (ES 2 570 653
B1): see docs/swatch.md.
"""
