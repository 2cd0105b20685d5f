"""Words of the family outputs."""
