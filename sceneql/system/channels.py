"""The channels of an island: the floats by which solvers, the march, terms and contacts pass numbers to one another.

The array of floats begins with HEAD numbers that any kernel may read as ``floats[channels.STAGE]``; numbers of the
script and memories of words follow. Where a solver needs slopes, three arrays of the state's size n stand at the end.
Only this file says where they are.
"""

(
    RATES,
    STEP_END,
    HOLDS,
    CHANGED,
    SETTLED,
    NEWTON,
    POSITIVE,
    STAGE,
    STAGES,
    GROWS,
    LAGS,
    STALE,
    STATIC,
    KEEPS,
    FIXED,
    EARLIER,
    HEAD,
) = range(17)
"""RATES: number of evaluations of the rate so far.

STEP_END: above 0, the planned end [s] of the step, which local contacts may only lower in this call; 0 where they
resolve impacts.

HOLDS: not 0 where a body rests on a local contact. In the next step the contact reads numbers that terms leave in the
floats for the state at the step's end, so the rate must be evaluated there.

CHANGED: not 0 where an exact contact, updating its resting pairs at the end of a step, changed the state or a flag.
Four values stop the march: NO_WAY_ON at an impact, where impacts accumulate without end; UNSEEN at the end of a step,
where bodies overlap, or are held apart, in a way that their contacts have not seen; COSTLY where contacts have taken
more work than they may; MADE, after which nothing else is changed and a shorter step is tried, where they made energy.

SETTLED: not 0 where nothing but the removal of errors (``samples`` of Assembly.after_step) has changed the state since
the end of the last step: a multistep method may then use what it remembers of earlier steps.

NEWTON: above 0 while Newton's method evaluates slopes. Slopes that contain a force itself then use the force that the
latest Newton update predicted (BEFORE, AFTER). The value is a^2 [s^2] of the stage: stiffness is weighed against
mass/a^2, and against nothing where a^2 is infinite (statics).

POSITIVE: not 0 where the Jacobian is built from the terms' positive slopes (Slopes.positive), instead of their slopes.

STAGE: the coefficient a [s] of an implicit stage y = base + a f(t, y), whose base stands in BASE; else one of the three
values below.

STAGES: number of implicit stages so far.

GROWS: not 0 where slopes have no place in the Jacobian yet (Assembly.grows): Newton's method gives up, and the march
repeats the step after the island has been laid out anew.

LAGS: a counter. Numbers that are constant while the equations of a stage are solved, as the normal loads in a friction
potential, are evaluated anew from the state in AFTER when it changes. STALE: the largest relative change of such
numbers at that evaluation; 1 where a stage has begun.

STATIC: RESTING in a march of static equilibria: prescribed motions then have neither velocity nor acceleration.
PLACING: the rates of prescribed positions are instead their distances from where they should be [m]. 0 in a march in
time.

KEEPS: not 0 where the entries of terms that have positive slopes, as strain does, stay in the Jacobian as they were
evaluated last: within a stage they change by far less than those of contacts.

FIXED: not 0 where no tolerance chooses the steps: exact contacts then look closer at the energy that a step makes.

EARLIER: above 0 while kernels that act after a step may ask for a shorter one: a part of the step, which they may only
lower in this call, changing nothing else. The step is then taken back and tried as long as that."""

NO_SLOPES, OUTSIDE, BETWEEN = 0.0, -1.0, -2.0
"""Values of STAGE, for contacts. NO_SLOPES: they act between steps, and no solver needs slopes. OUTSIDE: they act
within implicit stages, and none is being solved. BETWEEN: they act between steps, but a solver needs slopes; a body
that rests at a step's start then stays tied until its end, so that the rate is smooth within the step and has
slopes."""

RESTING, PLACING = 1.0, 2.0
"""Values of STATIC."""

NO_WAY_ON, UNSEEN, COSTLY, MADE = -1.0, -2.0, -3.0, -4.0
"""Values of CHANGED with which an impact stops the march."""
DUE = 2.0
"""Value of CHANGED with which the impact kernel is called at the end of a step where an impact is due. What the kernel
leaves unchanged then is as it was within the step, whose dense output may still be read."""

ARRAYS = BASE, BEFORE, AFTER = 3, 2, 1
"""The arrays at the end begin at ``floats.size - channels.BASE * n``. BASE: the base of a stage; BEFORE and AFTER: the
states before and after the latest Newton update, over which slopes predicted the force linearly."""
