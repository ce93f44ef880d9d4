"""What steps of live cloth cost, and what a hand does to it."""
