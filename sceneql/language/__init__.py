"""Text to tree: YAML, broken brackets, templates."""
