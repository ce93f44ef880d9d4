"""The speed-error report: error against CPU time, scene by scene; stored, drawn and compared."""
