"""First roots of rays in lanes."""
