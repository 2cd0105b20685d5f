"""Words of the family lights."""
