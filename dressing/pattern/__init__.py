"""Sewing patterns: panels, curved edges, stitches, the GarmentCode format."""
