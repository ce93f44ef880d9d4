"""The state of a cloth: nodes, material vertices, fabrics, pins, goals, and how its avatar moves."""
