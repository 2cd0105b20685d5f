"""Words of the family materials."""
