"""Frames drawn as triangles by OpenGL."""
