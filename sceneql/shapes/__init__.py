"""Geometry of object words: placement, CSG, mesh files."""
