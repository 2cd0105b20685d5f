"""Finite elements: shapes, meshes, forces."""
