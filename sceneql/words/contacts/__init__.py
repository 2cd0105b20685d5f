"""Words of the family contacts."""
