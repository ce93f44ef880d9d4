"""Physics and time: fabric, forces, linear solver, implicit step, frame loops."""
