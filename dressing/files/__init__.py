"""Files read and checked: glTF, OBJ, NPZ, TOML; what names suggest."""
