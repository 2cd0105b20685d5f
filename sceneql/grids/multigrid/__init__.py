"""Linear systems of grids."""
