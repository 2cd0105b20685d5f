"""The contract: what parts hand an island, a solver sees.

It is what models, forces and contacts hand to an island, and what a solver sees of it.

An island is a set of models that are solved together. Its state is one vector ``y``; its rate dy/dt = f(t, y) is the
sum of *terms*: compiled kernels of one signature, each called with its own integers and with the island's one array
of floats. All numbers of the script are inputs in that array (so a changed number compiles nothing); values that vary
in time are evaluated into it at every stage time before the terms run.

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
    tied_drift(functions, h, y0, kicked, y1, floats, ints)   ends a drift where ties hold, by other momenta before it
    step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints) -> error   one step of a solver: writes
                                            y1; the error is scaled by the tolerance (accept when <= 1), 0 for fixed
                                            steps
    dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out)   the solution inside the step, 0 <= theta <= 1

    limit(t, y, changed, floats, ints) -> part   how far from y to `changed` surfaces stay apart (Assembly.limit)
    slopes(t, y, entries, floats, ints)     adds the derivatives of one term (see Slopes)
    jacobian(functions, t, y, values, floats, ints)   the derivative of the island's rate (see Pattern)

A step gets the addresses of the functions it may call: ``rate = rate_at(functions[AT_RATE])`` and, for the Jacobian,
``jacobian = jacobian_at(functions[AT_JACOBIAN])`` (compiled/pointers_kernels.py); pass `functions` on to jacobian.
It may be called again from the same start with another h (a rejected step; the search for an event), and `dense`
belongs to the latest call. After an event y0 is not the y1 of the step before.

Stages: the terms run in the order `velocity` (what moves as a flow does takes its velocity), `internal` (a model's
own), `force`, `tie` (the forces by which bodies keep to their ties, found from all other forces), `close` (a model
turns newtons into accelerations by its inverse masses and writes dx/dt = v; what has no inertia hands them to the
flow), `constrain` (a resting contact removes accelerations into the surface, a flow loses its divergence).
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
