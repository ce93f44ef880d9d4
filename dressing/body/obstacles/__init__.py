"""Obstacles beside the body: furniture, hangers, balls; still, keyed or deforming."""
