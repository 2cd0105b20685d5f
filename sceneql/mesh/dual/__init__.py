"""Dual contouring: sharp edges kept."""
