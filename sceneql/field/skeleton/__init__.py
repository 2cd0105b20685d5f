"""Densities of points and curves."""
