"""Geometry that objects share: placement, CSG, files."""
