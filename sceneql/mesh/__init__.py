"""Implicit fields to triangles: extraction, file formats."""
