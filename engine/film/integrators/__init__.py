"""Integrators, one file each: how a stepper gets over a time step, in one stage or several."""
