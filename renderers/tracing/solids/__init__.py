"""Rays against what a frame holds: quadrics, triangles, implicit solids, grids."""
