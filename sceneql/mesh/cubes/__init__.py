"""Marching cubes: cells, curves on their faces, triangles, refinement."""
