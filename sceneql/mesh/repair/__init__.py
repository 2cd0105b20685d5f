"""Meshes put right: folded and self-intersecting triangles."""
