"""Repair of folds and self-intersections."""
