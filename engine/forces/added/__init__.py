"""Forces that few garments have: elastic along edges, pressure, enclosed gas, pins with times, keyed fields."""
