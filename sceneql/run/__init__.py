"""A run's moments, history, dry run, what is watched."""
