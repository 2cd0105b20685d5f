"""Named indices of the integers of forces between the masses of several models, and of the masses' integers."""

CONSTANT, SIGN, SOFTENING, POINTS, WEIGHTS, ROOM, OWN = range(7)
"""Of direct sums and of the tree: offsets of the constant c (taken with SIGN) and of the softening; room for 3 ROOM
places and for ROOM weights. Their OWN follow, then the masses, then for every model offset and step of its weights."""

MASSES, MODELS, ROWS = range(3)
"""Numbers of masses and of models; from ROWS on MODEL integers of each model."""
POSITION_AT, VELOCITY_AT, COUNT, FIRST, MASS_AT, MODEL = range(6)
"""Integers of a model; FIRST: index of its first mass among all masses."""
