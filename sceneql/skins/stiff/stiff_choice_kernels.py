# mypy: ignore-errors
"""Steps of an additive pair in which skins are explicit up to their bound, and implicit where that is worth it.

Steps that the tolerance chooses are explicit at first. Where stability rather than the flow holds them, by their mean,
and the flow's own would be longer than an implicit step costs explicit ones, skins are implicit for a trial, and go on
so while their steps are as long as that. After a trial in vain the next one waits, each time twice as long. Costs are
counts of operations, never times of a clock.

``settings`` and ``numbers``: as of stiff_step_kernels; the numbers of a CHOICE begin in the settings at the last but
one of ``numbers``.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.flows.layout import AT, FACES
from sceneql.flows.schemes.additive_kernels import FLOW_AT, STAGES, TABLES_AT
from sceneql.flows.schemes.additive_kernels import step as explicit_step
from sceneql.skins.skin_layout import BOX_AT
from sceneql.skins.stiff.stiff_lines_kernels import HEAD, TIE, release
from sceneql.skins.stiff.stiff_step_kernels import ANEW, BEGUN, HAS, STATE
from sceneql.skins.stiff.stiff_step_kernels import step as implicit_step
from sceneql.system.signatures_kernels import STEP, A, F, I

BOUND, COST, IMPLICIT, SINCE, TRIED, WAIT, LATER, MEAN, LATEST, CHOICE = range(10)
"""The longest explicit step [s]; explicit steps that an implicit one costs; 1 where skins are implicit; start of the
counted steps [s] and their number; explicit steps to wait for the next trial, and half those after it; the mean
explicit step before a trial [s]; start of the latest step [s]."""
WINDOW, WARM = 10, 15
"""Steps of which a mean is taken; those of a trial, in which steps grow, before the first."""
HELD, PASSED = 0.5, 0.3
"""Part of the bound from which on stability counts as what holds steps; the flow's own step, in the time in which the
fluid passes a cell (0.3 to 0.6 by the tolerance 1e-4, tests/bench/bench_skins.py)."""
KEPT = 0.7
"""Part of its cost that an implicit step replaces, at least, or it is left."""


@lean(types.float64(A, A, I, I), inner=True)
def passing(y, floats, lines, one):
    """The time [s] in which the fluid passes a cell at the largest speed of faces."""
    box = lines[HEAD + TIE + BOX_AT]
    fastest = 0.0
    for k in range(one[AT], one[AT] + one[FACES]):
        fastest = max(fastest, abs(y[k]))
    cell = min(floats[box + 3], floats[box + 4])
    return cell / fastest if fastest > 0.0 else math.inf


@lean(types.void(F, A, A, A, A, I, I), inner=True)
def choose(t, y, state, choice, floats, lines, one):
    """Choose the way of a step that begins at t; ``state``: of the implicit one."""
    choice[TRIED] += 1.0
    if choice[TRIED] <= 0.0:
        choice[SINCE] = t
    if choice[TRIED] < WINDOW:
        return
    mean = (t - choice[SINCE]) / choice[TRIED]
    choice[TRIED], choice[SINCE] = 0.0, t
    if choice[IMPLICIT] == 0.0:
        choice[WAIT] = max(0.0, choice[WAIT] - WINDOW)
        held = choice[WAIT] == 0.0 and mean >= HELD * choice[BOUND]
        if held and PASSED * passing(y, floats, lines, one) > choice[COST] * mean:
            choice[IMPLICIT], choice[MEAN], choice[TRIED] = 1.0, mean, -WARM
            state[ANEW], state[BEGUN], state[HAS] = 1.0, 0.0, 0.0
    elif mean < KEPT * choice[COST] * choice[MEAN]:
        choice[IMPLICIT], choice[LATER] = 0.0, 2.0 * choice[LATER]
        choice[WAIT] = choice[LATER]
        release(floats, lines)


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; its error by the embedded method."""
    last = numbers.size - 1
    lines, choice = numbers[numbers[last] :], settings[numbers[last - 1] :]
    room = (13 + 2 * numbers[STAGES]) * y0.size
    if t != choice[LATEST]:  # not one that is taken again, shorter
        choice[LATEST] = t
        before = choice[IMPLICIT]
        choose(t, y0, work[room : room + STATE], choice, floats, lines, numbers[numbers[FLOW_AT] :])
        if choice[IMPLICIT] != before:  # its first rate is by the other tensions
            settings[numbers[TABLES_AT] - 1] = -math.inf
    if choice[IMPLICIT] == 1.0:
        return implicit_step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints)
    return explicit_step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints)
