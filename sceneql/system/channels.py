"""The channels of an island: what solvers, the march, terms and contacts tell one another in its array of floats.

It begins with HEAD numbers that any kernel may read as ``floats[channels.STAGE]``; numbers of the script and memories
of words follow. Where a solver asks for slopes it ends with three arrays of the state's size n. This is the only
place that says where they are.
"""

RATES, STEP_END, HOLDS, CHANGED, DEFINITE, STAGE, STAGES, HEAD = range(8)
"""
RATES: how many times the rate was evaluated.

STEP_END: above 0 local contacts are only asked when the step, planned up to that time [s], should end, which they
lower; 0 when they are to back off.

HOLDS: not 0 where a local contact holds something, and so reads next time what terms leave in floats for the state at
the step's end: the rate must be evaluated there.

CHANGED: not 0 where an exact contact, put in order at the end of a step, changed the state or a flag.

DEFINITE: above 0 while slopes are asked for by Newton's method, and wherever slopes contain the force itself, it is
that which the latest change foresaw (BEFORE, AFTER). Far from a solution it is finite, and systems are to be positive
definite: what pushes masses away is left out as far as it exceeds DEFINITE [1/s^2] times the mass (system.Slopes).

STAGE: a [s] in a stage of Newton's method, y = base + a f(t, y), with its base in BASE; else one of the three below.

STAGES: how many such stages there were.
"""

NO_SLOPES, OUTSIDE, BETWEEN = 0.0, -1.0, -2.0
"""Of STAGE, for contacts. NO_SLOPES: they act between steps, and no solver asks for slopes. OUTSIDE: they act within
the stages of Newton's method, and none is being solved. BETWEEN: they act between steps, but a solver asks for slopes:
what rests at a step's start stays tied to its end, so that the rate is smooth there, and slopes are known."""

ARRAYS = BASE, BEFORE, AFTER = 3, 2, 1
"""The arrays at the end begin at ``floats.size - channels.BASE * n``. BASE: the base of a stage; BEFORE: the state
before the latest change of Newton's method, whose slopes foresaw the force; AFTER: the state after it."""
