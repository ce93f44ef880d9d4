"""Measurements that tailors take beyond those that drafts need, and their names in other programs."""
