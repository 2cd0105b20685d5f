"""Intersections of rays with the shapes of a frame."""
