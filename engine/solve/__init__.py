"""The linear system of a Newton iteration: block matrix, assembly, conjugate gradients."""
