"""The cloth mesh as remeshing sees it: nodes, material vertices, edges, faces around nodes."""
