"""Fabrics from measurements: KES, FAST, cantilever, Cusick drape and U3M."""
