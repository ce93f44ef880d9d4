"""What varies within a fabric: values on regions and edges of cloth, painted ones, and ones keyed in time."""
