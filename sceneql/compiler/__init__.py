"""Tree to graph: words found, fields read, limits."""
