"""The layout of radau's work, numbers and settings (see radau_stages_kernels), as named indices."""

MEMORY = 16
NEXT, START, LENGTH, BEFORE, GOOD_LENGTH, GOOD_ERROR, ERROR, CONVERGENCE, CONTRACTION, FACTORED = range(10)
"""Length to try next; start and length of the latest try; length of the step before it (0: unknown); length and error
of that step for the control; error of the try; Newton's convergence factor and rate; length that is factored."""
BEGUN, FRESH, REJECTED, CEILING = range(10, 14)
"""Whether there was a try; whether the Jacobian is that of the start; whether a try from here was rejected; length
beyond which Newton's iteration failed not long ago (0: none)."""

VECTORS = 16
FIXED, ROOM, TALLIES, SCALED, ROWS_AT, FACTOR, SOLVE, FILTER, HEAD = range(9)
RELATIVE, NEWTON, CONTRACTS, MEASURES = range(4)
