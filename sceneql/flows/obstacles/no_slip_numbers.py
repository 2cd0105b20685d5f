"""Distances that walls of solids in a flow count by (no_slip.py)."""

BESIDE = 0.1
"""Distance of a face's middle from a wall, in parts of a cell's side, from which on viscosity acts on it."""
NEAREST = 0.02
"""Least distance along an axis to a wall, in cells."""
FARTHEST = 1.5
"""The same of a wall just beyond the next middle."""
HALVINGS = 5
"""Of a side, before the level between its ends counts as linear."""
SLIVER = 0.02
"""Open part of a face below which it is closed: what little flows there would need a large pressure behind it."""
LEAST = 0.3
"""Least volume of a velocity's own cell, of a whole one: smaller ones have this inertia, for the sake of the step."""
UNEVEN = 0.05
"""What all walls together push into a closed box, in parts of what they push at all, from which on it has no place."""
