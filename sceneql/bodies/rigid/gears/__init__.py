"""Wheels that mesh: axles, and rows of gears."""
