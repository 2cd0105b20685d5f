"""Filling objects with masses and tetrahedra."""
