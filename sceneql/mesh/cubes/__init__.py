"""Marching cubes and finer cells."""
