"""Density fields of skeletons: points, segments, triangles, curves."""
