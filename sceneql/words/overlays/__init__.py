"""Words of the family overlays."""
