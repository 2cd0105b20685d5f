"""Where the integers of forces between the masses of several models are, and those of the masses: indices by name."""

CONSTANT, SIGN, SOFTENING, POINTS, WEIGHTS, ROOM, OWN = range(7)
"""Of direct sums and of the tree: offsets of the constant c (taken with SIGN) and of the softening; room for 3 ROOM
places and for ROOM weights. Their OWN follow, then the masses, then for every model offset and step of its weights."""

MASSES, MODELS, ROWS = range(3)
"""How many masses of how many models; from ROWS on MODEL integers of each."""
POSITION_AT, VELOCITY_AT, COUNT, FIRST, MASS_AT, MODEL = range(6)
"""FIRST: the number of its first mass among all."""
