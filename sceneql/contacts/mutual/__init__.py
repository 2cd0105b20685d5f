"""Contact of masses with one another."""
