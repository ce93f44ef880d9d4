"""Integrators: one file each; they act on `toile.engine.dynamics.Dynamics`."""
