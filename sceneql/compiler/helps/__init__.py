"""Help texts for what the reader meets: looked up only where there is an error."""
