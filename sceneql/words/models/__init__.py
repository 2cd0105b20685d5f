"""Words of the family models."""
