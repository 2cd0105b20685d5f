"""Words of the family cameras."""
