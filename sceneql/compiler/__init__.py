"""Tree to graph: words found, fields read and checked."""
