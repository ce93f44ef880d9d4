"""Triangulation of one flat panel: an outline in, a mesh of good triangles out."""
