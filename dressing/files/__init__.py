"""File formats: glTF, OBJ, NPZ, TOML and, through meshio, others; checks of surfaces."""
