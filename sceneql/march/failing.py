"""Messages of a failed march: part, entry, time and line, and whether the equations or the tolerance is at fault."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sceneql.failure import RunFailure
from sceneql.march import march_kernels as kernels
from sceneql.march.blame import culprit
from sceneql.march.pace import MOST_STEPS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.march.driver import Driver
    from sceneql.system import Control

GROWTH_LIMIT = 1e12
"""A run fails when an entry of y exceeds this factor times the largest entry at the start (at least 1, or the change
over the run by the initial rate)."""

LEAST = 1e-40
"""Shortest step, relative to the run, even at time 0."""
MESSAGES = {
    kernels.NOT_FINITE: "a value is no longer finite: the step is unstable, or the equations have no value there",
    kernels.GROWTH: f"the state has grown beyond {GROWTH_LIMIT:.0e} times its start: {{}}",
    kernels.STEP_TOO_SMALL: "the step that the tolerance asks for is below the resolution of time: {}",
    kernels.CROSSING: "surfaces would pass through one another within this step: take shorter ones",
    kernels.STUCK: "contacts push against each other at one instant without end",
    kernels.UNSEEN: "bodies are in each other, or held apart, by a contact that mode `exact` has not seen",
    kernels.COSTLY: "contacts take more work than they may",
    kernels.MADE: "contacts make or lose energy, in however short a step",
}
AHEAD = 1e-9
"""Interval ahead, relative to the time reached, in which a rate without a value is searched for."""
BEND = 1e-6
"""Relative change of a rate over DIGITS ulps of time from which on its solution counts as singular."""
DIGITS = 64
"""Number of ulps of time for BEND."""
ROUNDING = 1e-9
"""Relative change of an entry over these ulps below which the change is rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class Stopped:
    """The state of a march where it stopped."""

    system: System
    driver: Driver
    control: Control
    floats: Floats
    time: float
    """Time of the last good state [s]."""
    y: Floats
    rate: Floats
    end: float
    """End of the run [s]."""
    rate_at: Callable[[float, Floats], Floats]
    """dy/dt (n,) at a time [s] and state."""


def failure(march: Stopped, status: int, entry: int, ahead: float) -> RunFailure:
    """The failure of a march that stopped with a status; ``ahead``: the next step to be tried [s]."""
    control = march.control
    if status in (kernels.STUCK, kernels.UNSEEN, kernels.COSTLY, kernels.MADE):
        return _at_contact(march, status, entry)
    if status == kernels.CROSSING:
        return blamed(march, entry, MESSAGES[status])
    if status == kernels.PAUSED:
        return _hopeless(march, ahead)
    if status == kernels.STEP_TOO_SMALL:
        return _without_step(march, entry)
    if status == kernels.NOT_FINITE:
        if control.unsolved:
            return blamed(march, entry, control.unsolved)
        return blamed(march, entry, MESSAGES[status], dict.fromkeys((0.0, 0.5 * ahead, ahead)))
    why = "the equations run away" if control.adaptive else "the step is unstable"
    return blamed(march, entry, MESSAGES[status].format(why))


def _at_contact(march: Stopped, status: int, pair: int) -> RunFailure:
    """The failure of contacts, at the line of the pair's contact, or of the first contact that has advice."""
    message, first, advised = MESSAGES[status], 0, None
    for pairs, origin, help in march.system.events:
        own = status == kernels.STUCK and first <= pair < first + pairs
        if own or (help and advised is None):
            advised = origin, help
        if own:
            break
        first += pairs
    if advised is None or not advised[1]:
        return blamed(march, 0, message)
    origin, help = advised
    return RunFailure(message, part=origin.part, time=march.time, span=origin.span, help=help)


def blamed(march: Stopped, entry: int, message: str, aheads: Iterable[float] = ()) -> RunFailure:
    """The failure at an entry of the state.

    It names a term that is not finite at one of the times ``aheads`` [s] ahead.
    """
    t, y, rate = march.time, march.y, march.rate
    origin = march.system.origin(entry)
    span = origin.span
    for h in aheads:
        term = culprit(march.system, march.driver, march.floats, t + h, y + h * rate if h else y)
        if term is not None and term.part != origin.part:
            message, span = f"{message.partition(':')[0]}: '{term.part}' gives none", term.span or span
            break
    return RunFailure(message, part=origin.part, time=t, span=span)


def _without_step(march: Stopped, entry: int) -> RunFailure:
    """The failure where no step is short enough: the rate has no value ahead, is singular, or too inexact."""
    t, y, rate, text = march.time, march.y, march.rate, MESSAGES[kernels.STEP_TOO_SMALL]
    with np.errstate(all="ignore"):
        missing = _missing(march, t, y, rate)
        if missing is not None:
            at, h = missing
            return blamed(march, at, text.format(f"a singularity, beyond which {_rate_of(march, at)} no value"), (h,))
        h = DIGITS * max(float(np.spacing(t)), LEAST * march.end)
        change = np.abs(march.rate_at(t + h, y + h * rate) - rate)
        bending = (change > BEND * np.abs(rate)) & (h * np.abs(rate) > ROUNDING * np.abs(y))
    if bending.any():
        at = int(np.argmax(np.where(bending, np.abs(rate), 0.0)))
        return blamed(march, at, text.format(f"a singularity, where {_rate_of(march, at)} no bound"))
    limit = f"{march.control.tolerance:g}"
    return blamed(march, entry, text.format(f"rounding alone makes larger errors than its {limit}; take a larger one"))


def _hopeless(march: Stopped, step: float) -> RunFailure:
    """The failure of a march given up (`pace`) because its steps have long been too short."""
    entry = int(np.argmax(np.abs(march.rate)))
    name = march.system.name(entry)
    told = f"{f'the rate of {name}' if name else 'a rate'} is {march.rate[entry]:.3g} where it is {march.y[entry]:.3g}"
    text = f"more than {MOST_STEPS:.0e} steps as short as {step:.2g} s are left to the next instant: {told}"
    return blamed(march, entry, f"{text}; a number in it is too large, or a tolerance too small")


def _missing(march: Stopped, t: float, y: Floats, rate: Floats) -> tuple[int, float] | None:
    """The first entry whose rate has no value soon after time t [s], and how soon [s]; None if all have."""
    h = max(float(np.spacing(t)), LEAST * march.end)
    while h < AHEAD * max(t, AHEAD * march.end):
        bad = np.flatnonzero(~np.isfinite(march.rate_at(t + h, y + h * rate)))
        if len(bad):
            return int(bad[0]), h
        h *= 4.0
    return None


def _rate_of(march: Stopped, entry: int) -> str:
    name = march.system.name(entry)
    return f"the rate of {name} has" if name else "a rate has"
