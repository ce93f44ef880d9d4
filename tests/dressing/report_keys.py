"""What may differ between the reports of two runs of the same scene; all else is reproducible."""

VOLATILE_KEYS = ("wall_seconds", "cpu_seconds", "stage_seconds", "versions")
