"""Folds, self-intersections repaired."""
