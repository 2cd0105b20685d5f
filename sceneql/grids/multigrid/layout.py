"""Where a grid's linear solvers find the integers of their plan, and note what they did: indices by name."""

SOLVER, EXACT, NX, NY, NZ, AT, VOLUME, SINK, GX, GY, GZ, VARYING, MOST, FED, PLAN = range(15)
"""EXACT: 1 where a system is solved to rounding at once."""

FACTORED, TAKEN_IN, SOLVES, ITERATIONS, HISTORY, RECORD = 0, 1, 2, 3, 4, 132
"""Of the store's last entries: the a that is prepared (0: none), whether what does not depend on it is, systems solved,
iterations of all of them, then the residuals of the last one."""
