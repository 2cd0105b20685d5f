"""Text to tree: YAML, lost brackets, templates."""
