"""Triangles drawn by OpenGL."""
