"""Integrators, one file each: a time step of a stepper in one stage or several."""
