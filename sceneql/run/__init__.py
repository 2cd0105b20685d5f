"""A run's moments: history, what is watched, warnings."""
