"""Forces that few garments have: elastic edges, pressure, enclosed gas, pins with times, keyed fields."""
