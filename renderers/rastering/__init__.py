"""Rasterization by OpenGL."""
