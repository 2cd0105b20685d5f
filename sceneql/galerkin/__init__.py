"""Fields by finite elements: triangles, weak forms."""
