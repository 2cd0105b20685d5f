"""Words of the family objects."""
