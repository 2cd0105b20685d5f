"""Words of the family solvers."""
