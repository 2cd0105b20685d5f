"""Words of the family ties."""
