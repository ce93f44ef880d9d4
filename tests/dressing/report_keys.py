"""What may differ between the reports of two runs of the same scene; all else is reproducible."""

VOLATILE_KEYS = ("wall_seconds", "cpu_seconds", "stage_cpu_seconds", "stage_wall_seconds", "versions")
