"""First roots of many rays at once, in vector lanes."""
