"""Words of the family forces."""
