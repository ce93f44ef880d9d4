"""Comparisons with theory and with measured cloth, one case a file."""
