"""The layout of a plan's integers (described in systems_kernels): indices by name."""

PIECES_AT, PIECES, ENTRY, THREADS, PIECE_AT, UNIT, FORWARD, BACKWARD = range(8, 16)
SINGLE_FACTOR, SINGLE_SOLVE, SINGLE_PIECE, SINGLE_FORWARD, SINGLE_BACKWARD = range(16, 21)
IN_SINGLE, RESTING, EXACT, SCALE, STARTS_AT, COLUMNS_AT, HEAD = range(21, 28)
NEW, TRIED, WEAK = 1, 2, 3
"""IN_SINGLE of factors in single precision: new, found good, or to be refined; 0: they are in double precision."""
FIELDS = 11
PAD = 16
"""Zeros behind the factors of each front: lanes reach that far beyond a row."""
ROWS = 4
"""Rows of the factors that a solution reads at a time."""
BODY_UNKNOWNS, BODY_BLOCK = 6, 36
"""Unknowns of a rigid body, and numbers of a block of the matrix of some."""
