"""The channels of an island: how solvers, the march, terms and contacts pass numbers to one another in its floats.

The array begins with HEAD numbers that any kernel may read as ``floats[channels.STAGE]``; numbers of the script and
memories of words follow. Where a solver needs slopes, three arrays of the state's size n end it. Only this file says
where they are.
"""

RATES, STEP_END, HOLDS, CHANGED, SETTLED, NEWTON, POSITIVE, STAGE, STAGES, GROWS, LAGS, STALE, STATIC, HEAD = range(14)
"""
RATES: how many times the rate was evaluated.

STEP_END: above 0, the planned end [s] of the step, which local contacts may only lower in this call; 0 where they
resolve impacts.

HOLDS: not 0 where a body rests on a local contact. In the next step the contact reads numbers that terms leave in the
floats for the state at the step's end, so the rate must be evaluated there.

CHANGED: not 0 where an exact contact, updating its resting pairs at the end of a step, changed the state or a flag;
NO_WAY_ON where its events have no end, at an impact, and UNSEEN, at the end of a step, where bodies are otherwise than
their contacts tell, or COSTLY, where these have cost more work than they may: the march stops.

SETTLED: not 0 where nothing but what settles it (Assembly.after_step of samples) has changed the state since the end of
the last step: a method of several steps goes on with what it remembers.

NEWTON: above 0 while Newton's method evaluates slopes. A force that occurs in its own slopes is then the one that the
latest Newton update predicted (BEFORE, AFTER). It is a^2 [s^2] of the stage: stiffness counts beside mass/a^2, beside
nothing where it is infinite (statics).

POSITIVE: not 0 where the Jacobian is asked for the positive slopes of terms (Slopes.positive), in their kernels' place.

STAGE: the coefficient a [s] of an implicit stage y = base + a f(t, y), its base in BASE; else one of the three below.

STAGES: how many implicit stages there were.

GROWS: not 0 where slopes have no place in the Jacobian yet (Assembly.grows): Newton's method gives up, and the march
takes the step again when the island has been laid out anew.

LAGS: how many times numbers that a stage holds while its equations are solved were taken anew, as the loads of friction
with a potential: from the state in BEFORE, when this changes. STALE: the largest part by which such numbers changed
then; 1 where a stage has begun.

STATIC: RESTING where a march is one of rests: what is led then has neither velocity nor acceleration. PLACING: rates of
its positions are instead how far it is from its places [m]. 0 in a march in time.
"""

NO_SLOPES, OUTSIDE, BETWEEN = 0.0, -1.0, -2.0
"""Values of STAGE, for contacts. NO_SLOPES: they act between steps, and no solver needs slopes. OUTSIDE: they act
within implicit stages, and none is being solved. BETWEEN: they act between steps, but a solver needs slopes: a body
that rests at a step's start stays tied up to its end, so that the rate is smooth within the step and has slopes."""

RESTING, PLACING = 1.0, 2.0
"""Values of STATIC."""

NO_WAY_ON, UNSEEN, COSTLY = -1.0, -2.0, -3.0
"""Values of CHANGED with which an impact stops the march."""
DUE = 2.0
"""Value of CHANGED that an impact finds at the end of a step at which one is due: what it leaves alone then is still as
it was within the step, whose dense output may be asked for."""

ARRAYS = BASE, BEFORE, AFTER = 3, 2, 1
"""The arrays at the end begin at ``floats.size - channels.BASE * n``. BASE: the base of a stage; BEFORE and AFTER: the
states before and after the latest Newton update, across which the slopes predicted the force linearly."""
