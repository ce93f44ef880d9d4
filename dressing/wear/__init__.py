"""From garments to a draped cloth: start positions, layers, assembly, the outcome."""
