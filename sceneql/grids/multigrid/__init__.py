"""Linear systems of grids, solved."""
