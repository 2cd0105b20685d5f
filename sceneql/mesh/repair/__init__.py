"""Folded, crossing triangles mended."""
