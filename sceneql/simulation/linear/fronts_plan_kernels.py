# mypy: ignore-errors
"""How the integers of a plan lie (fronts_kernels.py says what they are)."""

PIECES_AT, PIECES, ENTRY, THREADS, PIECE_AT, UNIT, FORWARD, BACKWARD, HEAD = range(8, 17)
FIELDS = 11
