"""Incompressible flow: staggered grids, projection."""
