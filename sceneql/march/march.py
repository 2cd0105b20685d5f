"""The march of one island: compiled steps past the requested instant, at which dense output gives the state."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

import sceneql.system.channels as channels
from sceneql.compiled.kernels import compiled
from sceneql.doing import doing
from sceneql.failure import LimitRefused
from sceneql.island.breakpoint_table import before, next_breakpoint
from sceneql.island.island import IslandAssembly
from sceneql.island.system import System
from sceneql.march import march_kernels as kernels
from sceneql.march.driver import driver
from sceneql.march.engaged import Methods
from sceneql.march.failing import GROWTH_LIMIT, LEAST, Stopped, blamed, failure
from sceneql.march.first_step import first_step
from sceneql.march.pace import Pace
from sceneql.march.statistics import Statistics
from sceneql.march.switching import Switch
from sceneql.march.within_contact import WithinContact
from sceneql.system.stepping import UNREAD

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats
    from sceneql.system import Stepper

TOUCHING = 1e-13
"""Gap that counts as touching, relative to the largest position at the start or 1 m."""

ENTRIES_A_CALL = 20_000_000
"""Steps times entries of y in one compiled call, so that a long run can be interrupted."""

AT_ONCE, ENTRIES_AT_ONCE = 16, 20_000
"""Number of steps in the first call: steps of flows may take as long as all those of later calls. Where y is short it
is as many as have so many entries."""
LARGEST = 1e100
"""Largest number at the start in SI units, so that the square of its growth does not overflow."""


class March:
    """The integration of an island from 0 to ``end`` [s] by one solver."""

    def __init__(
        self,
        system: System,
        stepper: Stepper,
        end: float,
        *,
        stiff: Stepper | None = None,
        stiff_cost: float | None = None,
        otherwise: Stepper | None = None,
        with_jacobian: Callable[[], System] | None = None,
        before: March | None = None,
        kept: int = 0,
    ) -> None:
        """``stiff``, ``otherwise``: methods that may replace ``stepper`` (kinds.Methods, also of ``stiff_cost``).

        ``with_jacobian``: lays the island out again, with its Jacobian, for one of them that needs it. ``before``: a
        march that stops where this begins; its first entries and its first ``kept`` floats are this one's, too.
        """
        self.system, self.stepper, self.end = system, stepper, end
        self._otherwise, self._with_jacobian = otherwise, with_jacobian
        self.statistics = Statistics()
        self.floats = system.floats.copy()
        self.driver = driver(system)
        n = len(system.y)
        self._y0, self._rate0, self._rate1, self._sample = (np.zeros(n) for _ in range(4))
        self._y1: Floats = system.y.copy() if before is None else before.stopped().y[:n].copy()
        self._gaps = np.zeros(3 * system.pairs)
        self._leaving = np.zeros(system.pairs, dtype=np.int64)
        self._clock = np.zeros(kernels.CLOCKS)
        self._counts = np.zeros(kernels.COUNTS, dtype=np.int64)
        self._counts[kernels.LOCAL] = bool(system.structure.local)
        self._counts[kernels.ACTS] = bool(system.structure.after)
        self._counts[kernels.SETTLES] = bool(system.structure.settling)
        self._counts[kernels.PENDING] = -1
        self._clock[kernels.ERROR] = 1e-4
        self._clock[kernels.LARGEST] = min(stepper.control.largest_step, system.largest_step)
        self._clock[kernels.LEAST] = LEAST * end
        self._started = False
        self.corrected: Floats | None = None
        """(n,) correction of the state at the start, as of velocities that ties forbid; None: no kernel corrects the
        state."""
        self._floats_time = math.nan
        self._alone, self._within = np.zeros(n, dtype=bool), WithinContact(system)
        self._methods = Methods(several=stiff is not None)
        self._switch = None
        if stiff is not None:
            local = bool(system.structure.local)
            self._switch = Switch(stepper, stiff, self.rate, system.partner, end, cost=stiff_cost, local=local)
        self._last_look = 0
        self._at_once = max(AT_ONCE, ENTRIES_AT_ONCE // (n + 1))
        self._from = 0.0 if before is None else self._go_on_from(before, kept)
        """Start of the march [s]."""
        self._look_for_breakpoint(self._from)
        self._engage(stepper)

    def _go_on_from(self, before: March, kept: int) -> float:
        """Begin where another march ends, with its cost and first ``kept`` floats; returns that time [s]."""
        self.floats[channels.HEAD : kept] = before.floats[channels.HEAD : kept]
        self.floats[channels.RATES] = before.floats[channels.RATES]
        self.statistics = before.statistics
        for k in (kernels.STEPS, kernels.REJECTED, kernels.EVENTS):
            self._counts[k] = before._counts[k]
        self._clock[[kernels.T0, kernels.T1]] = before.time
        return before.time

    def _engage(self, stepper: Stepper) -> None:
        """Prepare a method and continue with it. Raises LimitRefused where it does not accept the island."""
        if stepper.needs.jacobian and self._with_jacobian is not None:
            self.system = self._with_jacobian()
            self.driver = driver(self.system)
            self.floats = np.concatenate([self.floats, self.system.floats[len(self.floats) :]])
            self._with_jacobian = None
        if self.system.structure.local or self.system.structure.limits:
            slopes = stepper.needs.jacobian
            self.floats[channels.STAGE] = self.system.floats[channels.STAGE] if slopes else channels.NO_SLOPES
        self.floats[channels.FIXED] = not stepper.control.adaptive
        self._engaged = engaged = self._methods.begin(self.system, stepper, self.driver, counts=self._counts)
        self._settings, self._numbers, self._work = engaged.settings, engaged.numbers, engaged.work
        self._alone = engaged.alone
        self._extended = math.nan
        self.prepared_text = engaged.text

    def _take_over(self, stepper: Stepper) -> None:
        """Continue with another method, which takes over the error scales."""
        before = self._engaged
        self._engage(stepper)
        self._engaged.measure_as(before)

    def _grow(self) -> bool:
        """Lay the island out with more places in its Jacobian, keeping the method's memory; False: it needs no more."""
        self.floats[channels.GROWS] = 0.0
        system, before = self.system.grown(self.floats), self._engaged
        if system is None:
            return False
        self.floats, self.system, self.driver = system.after(self.floats), system, driver(system)
        self._engage(before.stepper)
        self._engaged.go_on(before)
        self.statistics.orderings += 1
        return True

    def _look_for_breakpoint(self, time: float) -> None:
        """Find the next breakpoint after an instant; adaptive steps end a few ulps before it."""
        self._stop = next_breakpoint(self.system.stops, time, self.end) if self.stepper.control.adaptive else self.end
        self._step_end = before(self._stop) if self._stop < self.end else self.end

    def _pass_breakpoint(self) -> None:
        """Move past a breakpoint: the next step begins with the values behind it."""
        self._clock[kernels.T1] = self._stop
        self._rate1[:] = self.rate(self._stop, self._y1)
        self._floats_time = math.nan
        self._look_for_breakpoint(self._stop)

    def _change(self, switch: Switch, t: float) -> None:
        """Continue with the method that the switch has chosen; with the explicit one if that refuses the island."""
        try:
            self._take_over(switch.active)
        except LimitRefused as refusal:
            switch.refuse(t, refusal.diagnostic.message)
            self._take_over(switch.active)

    def choices(self) -> list[tuple[float, str]]:
        """(time [s], method and reason) of each choice of a method by the solver; before the run, of the first."""
        if self._switch is None:
            return []
        if not self._started:
            self._start()
        return self._switch.history

    @property
    def scratch(self) -> Floats:
        """Scratch of the steps, where a solver may record statistics."""
        return self._work

    def rate(self, t: float, y: Floats) -> Floats:
        """dy/dt (n,) at a time [s] and state, not counted as cost; the floats then hold the values at that time."""
        rate = np.empty_like(y)
        counted = self.floats[channels.RATES]
        self.driver.rate(t, y, rate, self.floats, self.system.ints)
        self.floats[channels.RATES] = counted
        self._floats_time = t
        return rate

    def floats_at(self, t: float, y: Floats) -> Floats:
        """The island's floats, with varying values evaluated at a time [s]."""
        if self._floats_time != t:
            self.rate(t, y)
        return self.floats

    def advance(self, t: float) -> tuple[Floats, Floats]:
        """State and rate (n,) at an instant [s], not before the last one requested; past the end, those at the end.

        Raises RunFailure, with the part and line of the entry of the state that failed.
        """
        t = min(t, self.end)
        y, at_the_end = self._reach(t)
        y = y.copy() if at_the_end else y
        return y, self.rate(t, y)

    def view(self, t: float) -> tuple[Floats, Floats]:
        """As `advance`, without copies: valid until the next call; at the end of a step with the step's own rate."""
        t = min(t, self.end)
        y, at_the_end = self._reach(t)
        known = at_the_end and self._counts[kernels.LAST_STAGE] != UNREAD
        return y, self._rate1 if known else self.rate(t, y)

    def memory(self, name: str, assembly: IslandAssembly, t: float, y: Floats) -> tuple[Floats, tuple[int, ...]]:
        """A contact's memory at the instant reached: the island's floats, and the integers with offsets into them."""
        return self.floats_at(t, y), assembly.remembered(name)

    def _reach(self, t: float) -> tuple[Floats, bool]:
        """March to an instant.

        Returns the state there, and whether it is the end of a step, in the march's own array.
        """
        if not self._started:
            self._start()
        if t > self._clock[kernels.T1]:
            with doing("solving") as deed:
                self._march(t, Pace(deed, t, self.time, int(self._counts[kernels.STEPS])))
        t0, t1 = float(self._clock[kernels.T0]), float(self._clock[kernels.T1])
        if not t < t1:
            return self._settled(t, self._y1), True
        h = t1 - t0
        engaged = self._engaged
        altered = bool(self._counts[kernels.ALTERED]) and not engaged.mixed
        if engaged.extend is not None and self._extended != t1 and not altered:
            self._extend_step(t0, h)
            self._extended = t1
        y = np.empty_like(self._y1)
        # Dense output still has the errors that settling removes at the step's end, and lacks changes by contacts.
        settles, touched = bool(self._counts[kernels.SETTLES]) and not altered, bool(self._counts[kernels.LOCAL])
        y1 = self._sample if settles and not touched else self._y1
        steps = (self._y0, self._rate0, y1, self._rate1, self._work, self._settings, self._numbers)
        dense = kernels.hermite if altered else engaged.dense
        dense((t - t0) / h, h, *steps, y)
        if engaged.mixed or (settles and touched):
            changed = self._sample != self._y1
            if changed.any():
                self._within.read((t - t0) / h, h, steps, changed, y)
        return self._settled(t, y), False

    def _settled(self, t: float, y: Floats) -> Floats:
        """A state for reading, with accumulated errors removed (a copy, if any kernel does so)."""
        if self._counts[kernels.SETTLES]:
            y = y.copy()
            self.driver.settle(t, t, y, self._rate1, y, self.floats, self.system.ints)
        return y

    def _extend_step(self, t0: float, h: float) -> None:
        """Compute the further stages of the last step's dense output; not counted, as frames must not change costs."""
        counted = self.floats[channels.RATES]
        step = (self._y0, self._rate0, self._y1, self._work, self._settings, self._numbers)
        self._engaged.extend(self._engaged.functions, t0, h, *step, self.floats, self.system.ints)
        self.floats[channels.RATES] = counted
        self._floats_time = math.nan

    def _start(self) -> None:
        self._started = True
        y = self._y1
        if self.system.pairs:
            self.driver.impact(self._from, y, -1, self.floats, self.system.ints)
        if self._counts[kernels.SETTLES]:
            settled = self._settled(self._from, y)
            self.corrected = settled - y if self._from == 0.0 else None
            y[:] = settled
        self._rate1[:] = self.rate(self._from, y)
        size, speed = np.abs(y).max(initial=0.0), np.abs(self._rate1).max(initial=0.0)
        if not (size <= LARGEST and speed <= LARGEST):
            k = int(np.flatnonzero(~(np.maximum(np.abs(y), np.abs(self._rate1)) <= LARGEST))[0])
            finite = math.isfinite(y[k]) and math.isfinite(self._rate1[k])
            what = f"has a value beyond {LARGEST:.0e}" if finite else "has no finite value"
            message = f"the {'state' if abs(y[k]) > LARGEST else 'rate'} {what} at the start"
            raise blamed(self.stopped(), k, message, () if finite else (0.0,))
        self._clock[kernels.LIMIT] = GROWTH_LIMIT * max(1.0, size, speed * self.end)
        if self.system.pairs:
            self._clock[kernels.SLOP] = TOUCHING * np.abs(y[self.system.partner >= 0]).max(initial=1.0)
        step = self.stepper.control.first_step
        step = step or first_step(self.stepper, y, self._rate1, self._alone, self.end, self.rate)
        if self._switch is not None:
            stiff, longest = self._switch.stiff, step
            if stiff.method.order == 2:  # its steps are shorter than those of an explicit one of order 8
                longest = first_step(stiff, y, self._rate1, self._alone, self.end, self.rate)
            self._switch.start(y, min(step, longest))
            if self._switch.active is not self.stepper:
                self._change(self._switch, self._from)
        self._clock[kernels.STEP] = step

    def _march(self, target: float, pace: Pace) -> None:
        started = time.perf_counter() - compiled.seconds
        counts, clock = self._counts, self._clock
        if counts[kernels.HELD] and not math.isnan(self._floats_time):
            # Frames evaluated the terms at other states: restore their values at the step's end, which contacts read.
            self.rate(float(clock[kernels.T1]), self._y1)
        self._floats_time = math.nan
        left = 0
        while True:
            if not left:
                left = max(100, ENTRIES_A_CALL // (len(self._y1) + 10))
                left = min(left, pace.until_look or left)
                if self._switch is not None:
                    left = min(left, self._last_look + self._switch.until_look - int(counts[kernels.STEPS]))
            part = counts[kernels.LEFT] = min(left, self._at_once)
            began = time.perf_counter() - compiled.seconds
            status = kernels.march(
                self._engaged.functions, min(target, self._step_end), self._step_end,
                self._y0, self._rate0, self._y1, self._rate1, self._sample,
                self._work, self._settings, self._numbers, self.floats, self.system.ints,
                self._gaps, self._leaving, clock, counts,
            )  # fmt: skip
            if counts[kernels.SWAPPED]:
                self._y0, self._rate0, self._y1, self._rate1 = self._y1, self._rate1, self._y0, self._rate0
                counts[kernels.SWAPPED] = 0
            left = left - part if status == kernels.PAUSED else 0
            if status == kernels.PAUSED:
                self._at_once = pace.at_once(self.time, part, time.perf_counter() - compiled.seconds - began)
                if left:
                    continue
                self._look()
                if pace.hopeless(self.time, int(counts[kernels.STEPS])):
                    break
            elif status == kernels.REACHED and target > self._step_end:
                self._pass_breakpoint()
            elif status == kernels.GROWS and self._grow():
                continue
            elif not self._goes_on(status):
                break
        done = self.statistics
        done.steps, done.rejected, done.events = (
            int(counts[k]) for k in (kernels.STEPS, kernels.REJECTED, kernels.EVENTS)
        )
        done.evaluations = int(self.floats[channels.RATES])
        done.seconds += time.perf_counter() - compiled.seconds - started
        if status != kernels.REACHED:
            self.fail(status)

    @property
    def time(self) -> float:
        """End of the last step [s]."""
        return float(self._clock[kernels.T1])

    def fail(self, status: int) -> None:
        """Raise the RunFailure of the compiled march's status."""
        found = failure(self.stopped(), status, int(self._counts[kernels.INDEX]), float(self._clock[kernels.STEP]))
        raise found.giving_way() if self.system.gives_way else found

    def stopped(self) -> Stopped:
        """The present state of the march, for failures."""
        state = self.stepper.control, self.floats, self.time, self._y1, self._rate1
        return Stopped(self.system, self.driver, *state, self.end, self.rate)

    def _look(self) -> None:
        """Switch methods where a check is due and the other method is better."""
        switch, clock = self._switch, self._clock
        steps = int(self._counts[kernels.STEPS]) - self._last_look
        if switch is None or steps < switch.until_look:
            return
        self._last_look += steps
        t, step = float(clock[kernels.T1]), float(clock[kernels.STEP])
        if switch.look(t, self._y1, step, steps):
            self._change(switch, t)
            clock[kernels.STEP] = switch.stable(t, self._y1, step)
            clock[kernels.ERROR] = 1e-4
        if self._counts[kernels.HELD]:
            self.rate(t, self._y1)  # restore the terms' values at this state, which contacts read

    def _goes_on(self, status: int) -> bool:
        """Whether another method continues where the present one finds no step."""
        if status == kernels.NOT_FINITE and self._otherwise is not None:
            self.stepper, self._otherwise = self._otherwise, None
            self._take_over(self.stepper)
            return True
        return status == kernels.STEP_TOO_SMALL and self._give_up()

    def _give_up(self) -> bool:
        """Whether the explicit method continues where the stiff one finds no step short enough."""
        switch, clock = self._switch, self._clock
        t = float(clock[kernels.T1])
        if switch is None or not switch.give_up(t):
            return False
        self._last_look = int(self._counts[kernels.STEPS])
        self._change(switch, t)
        clock[kernels.STEP] = switch.stable(t, self._y1, float(clock[kernels.STEP]))
        clock[kernels.ERROR] = 1e-4
        return True
