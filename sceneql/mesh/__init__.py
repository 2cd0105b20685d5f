"""Implicit fields to triangles: marching cubes with the topology of the trilinear interpolant."""
