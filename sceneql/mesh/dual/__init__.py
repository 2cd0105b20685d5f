"""Dual contouring: meshes that keep sharp edges and corners."""
