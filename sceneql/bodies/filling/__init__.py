"""Masses, tetrahedra in objects."""
