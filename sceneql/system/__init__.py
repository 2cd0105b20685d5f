"""The contract: what parts hand an island, a solver sees.

An island is a set of models that are solved together. Models, forces and contacts add to it through an `Assembly`; a
solver sees its state, its rate and its Jacobian. The state is one vector ``y`` (n,). Its rate dy/dt = f(t, y) is the
sum of *terms*: compiled kernels of one signature, each called with its own integers ``ints`` and with the island's one
array ``floats``. All numbers of the script are inputs in that array, so a changed number compiles nothing. Values that
vary in time are evaluated into it at every stage time, before the terms run.

Kernel signatures (numba; the types are in signatures_kernels.py), all ``-> None`` unless said:

    term(t, y, rate, floats, ints)          adds its part to rate (n,). Forces add newtons to the velocity entries
    gap(t, y, gaps, floats, ints)           writes signed distances [m] of its contact pairs, > 0 apart (exact mode)
    impact(t, y, pair, floats, ints)        changes y by the impulse of that pair (exact mode)
    back_off(t0, t1, y0, rate0, y1, floats, ints)   resolves each mass's impacts within the step, in y1 (local mode);
                                            where channels.STEP_END is above 0 it only lowers that end of the step
    after_step(t0, t1, y0, rate0, y1, floats, ints) -> bool   acts at the end of an accepted step, before contacts do;
                                            True where it changed the state or the floats: then frames inside the step
                                            are read off its cubic Hermite interpolant, and the rate is evaluated anew
    free_motion(h, y, floats, ints)         moves entries of y by their exact motion without forces over h
    tied_drift(functions, h, y0, kicked, y1, floats, ints)   corrects the momenta before a drift, and the drifted
                                            state, so that the drift ends where ties hold
    step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints) -> error   one step of a solver: writes
                                            y1; the error is scaled by the tolerance (accept when <= 1), 0 for fixed
                                            steps
    dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out)   the solution inside the step, 0 <= theta <= 1
    limit(t, y, changed, floats, ints) -> part   fraction of the line from y to `changed` before surfaces pass through
                                            each other (Assembly.limit)
    slopes(t, y, entries, floats, ints)     adds the derivatives of one term (see Slopes)
    jacobian(functions, t, y, values, floats, ints)   the derivative of the island's rate (see Pattern)

A step gets the addresses of the functions it may call: ``rate = rate_at(functions[AT_RATE])`` and, for the Jacobian,
``jacobian = jacobian_at(functions[AT_JACOBIAN])`` (compiled/pointers_kernels.py); pass `functions` on to jacobian. It
may be called again from the same start with another h (a rejected step; the search for an event), and `dense` belongs
to the latest call. After an event y0 is not the y1 of the step before.

Stages: the terms run in the order `velocity` (skins and masses that a flow carries take the fluid's velocity),
`internal` (a model's own forces or rates), `force`, `tie` (constraint forces of ties, found from all other forces),
`close` (a model multiplies forces by its inverse masses and writes dx/dt = v; skins without inertia hand their forces
to the flow), `constrain` (a resting contact removes accelerations into the surface, a flow's rate is projected to zero
divergence).
"""

from sceneql.system.assembly import Assembly, Mode
from sceneql.system.fields import Cells, Fields, Flow, Grid, Membrane
from sceneql.system.state import Bodies, Immersed, ModelState, Place, Skin, Springs, Turning
from sceneql.system.stepping import Control, IslandFacts, Method, Needs, Prepared, Stepper
from sceneql.system.terms import Pattern, Slopes, Stage
from sceneql.system.ties import Drive, Led, Mover, Tied, TieRow

__all__ = [
    "Assembly",
    "Bodies",
    "Cells",
    "Control",
    "Drive",
    "Fields",
    "Flow",
    "Grid",
    "Immersed",
    "IslandFacts",
    "Led",
    "Membrane",
    "Method",
    "Mode",
    "ModelState",
    "Mover",
    "Needs",
    "Pattern",
    "Place",
    "Prepared",
    "Skin",
    "Slopes",
    "Springs",
    "Stage",
    "Stepper",
    "TieRow",
    "Tied",
    "Turning",
]
