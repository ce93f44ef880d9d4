"""Forces, one file each."""
