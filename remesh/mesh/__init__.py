"""The cloth mesh of remeshing: nodes, material vertices, edges, faces around nodes."""
