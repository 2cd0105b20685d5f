"""Geometry of object words: placement, CSG, OBJ files."""
