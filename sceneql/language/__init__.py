"""Text to tree: the composer over PyYAML events, include, templates, patches. Knows no physics and no words."""
