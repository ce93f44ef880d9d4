"""Arrays, triangle meshes and bending stencils shared by all packages. Knows no physics."""
