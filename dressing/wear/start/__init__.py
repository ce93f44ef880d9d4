"""Where panels start, so that their seams close: tiers below each other, arms raised, panels rolled."""
