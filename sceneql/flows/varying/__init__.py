"""Fluids of several densities and viscosities."""
