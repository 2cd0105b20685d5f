"""One pass a file: prune, islands, sizes."""
