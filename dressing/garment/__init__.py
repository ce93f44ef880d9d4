"""Garments as meshes with rest shapes and fabrics, from patterns or from 3-D meshes."""
