"""Lights, shadows, sky and shading at a point."""
