"""Waves on grids."""
