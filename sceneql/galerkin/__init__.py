"""Fields by finite elements."""
