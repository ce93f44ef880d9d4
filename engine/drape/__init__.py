"""A drape to equilibrium: sewing, growing, settling, and the audited frame loop."""
