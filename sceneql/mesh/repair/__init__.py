"""Folds, crossing triangles mended."""
