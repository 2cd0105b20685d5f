"""Incompressible flow on staggered grids: advection, viscosity, projection."""
