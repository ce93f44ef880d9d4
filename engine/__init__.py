"""Time and physics: fabric, forces, assembly, solver, the frame loop."""
