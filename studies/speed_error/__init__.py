"""The speed-error report: what error costs how much time, scene by scene, stored, drawn and compared."""
