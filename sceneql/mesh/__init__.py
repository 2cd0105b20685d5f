"""Implicit fields to triangles: extraction, formats."""
