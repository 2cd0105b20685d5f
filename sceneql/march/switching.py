"""The switch between an explicit and a stiff method on an island: chosen at the start, reconsidered during the run.

An explicit step is limited by stability, not by the tolerance, where its length times the fastest mode lies at the
boundary of its stability region (Hairer & Wanner 1996, IV.2). Then a stiff method is tried, and kept as long as each of
its steps replaces more explicit steps than it costs. Costs are counts of steps and operations, never times of a clock.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sceneql.march.spectrum import boundary, dominant, least_boundary, spectrum
from sceneql.stepping.radau_systems import LARGEST, step_cost

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.march.spectrum import Complexes, Partners, Rate
    from sceneql.system import Stepper

HELD = 0.5
"""Fraction of the stability boundary from which on stability counts as limiting the step."""
DECAYED = 0.05
"""As HELD, for a decaying mode, where a trial in vain would cost at most a fifth of the remaining steps. At tolerances
below some 1e-9 the rounding of what has decayed, amplified by the fast mode in the error estimate, keeps steps as short
as that."""
FIRST, LAST = 200, 6400
"""Number of explicit steps before the first check, and largest number between two checks."""
STAGES = 7
"""Stages of dopri5, in whose steps costs are measured."""
LONG = 100
"""Number of steps of radau for a decay and its aftermath at a tolerance of 1e-4; it grows as the tolerance to the power
-1/4."""
SWITCHING = 500
"""Cost of a change of method in explicit steps, for a small island, which is laid out for it: more steps must
remain."""
KEPT = 2400
"""Excess cost, in explicit steps, that is allowed to a stiff method which has become slow: a change and one back, and
its smaller errors, which are far below its tolerance where the explicit method's are not."""
LARGE = 100
"""Number of unknowns from which on these costs decrease, as a step takes longer."""
TRIAL = 100
"""Number of steps of a stiff method before a mean step length is measured, and again until it is first judged."""
EARLY = 10
"""Number of checks in such a trial where local contacts act, since each mass that lands may cut a stiff step short: one
in which stiff steps are shorter than the explicit ones before ends it."""
PATIENCE = 1 / 3
"""Fraction of its cost that a stiff step has to replace: vibrations excited at its start take some time to damp."""


class Switch:
    """The choice of the method of one march."""

    def __init__(
        self,
        explicit: Stepper,
        stiff: Stepper,
        rate_at: Rate,
        partner: Partners,
        end: float,
        *,
        cost: float | None = None,
        local: bool = False,
    ) -> None:
        """``rate_at``, ``partner``: the island's, see `spectrum`; ``end`` [s]: that of the run.

        ``cost``: steps of dopri5 that a stiff step costs; by default as many as one of radau.

        ``local``: whether local contacts act. Their modes hold no explicit step, which backs off: stiff steps that are
        shorter than the explicit ones before are worth nothing, however fast these modes.
        """
        self.explicit, self.stiff = explicit, stiff
        self._local = local
        self._early = 0
        """Number of checks left of a trial where local contacts act."""
        self._held = 0.0
        """Mean explicit step [s] before the stiff method took over; 0 where it was the first."""
        self._rate_at, self._partner, self._end = rate_at, partner, end
        self.size = int((partner < 0).sum())
        """Unknowns of the stiff method's linear systems."""
        self.active = explicit
        self.history: list[tuple[float, str]] = []
        """(time [s], method and reason) of each choice."""
        self.until_look = self._between = FIRST
        self._since = 0.0
        self._warming = False
        self._warm = 0.0
        """Time [s] from which on the steps of a trial in contact are judged."""
        self._lost = 0.0
        """Excess cost of the stiff method so far, in explicit steps."""
        self._proven = True
        """Whether the stiff method has replaced enough explicit steps, or certainly would."""
        self._part = 1.0
        """Length of the explicit method's steps, relative to the longest stable one."""
        self._in_vain = 0
        """Number of consecutive trials of the stiff method in vain: each doubles the explicit steps before the next
        trial."""
        self._possible = self.size <= LARGEST
        self._cost = step_cost(self.size) if cost is None else cost

    @property
    def cost(self) -> float:
        """Cost of one stiff step, in explicit steps."""
        return self._cost * STAGES / (len(self.explicit.method.stability) - 1)

    @property
    def switching(self) -> float:
        """Cost of a change of method, in explicit steps."""
        return SWITCHING / (1.0 + self.size / LARGE)

    @property
    def _kept(self) -> float:
        """Excess cost, in explicit steps, at which the stiff method is left."""
        return KEPT / (1.0 + self.size / LARGE)

    @property
    def least_run(self) -> float:
        """Number of steps in which the stiff method follows a decay and its aftermath."""
        return LONG * math.sqrt(math.sqrt(1e-4 / self.stiff.control.tolerance))

    def _dies_out(self, values: Complexes) -> bool:
        """Whether the fastest mode decays; False for a pair of a decaying and a growing mode, as near a heavy body."""
        fastest = dominant(values)
        return -fastest.real > max(abs(fastest.imag), 10.0 * float(values.real.max(initial=0.0)))

    @property
    def _often(self) -> int:
        """Number of stiff steps between two checks: they cost as much as LAST explicit ones."""
        return max(TRIAL, int(LAST / self.cost))

    def start(self, y: Floats, step: float) -> None:
        """Choose the first method; ``step`` [s]: an estimate of the step that the tolerance allows at the start."""
        values = self._spectrum(0.0, y)
        speed = dominant(values)
        explicit_steps = self._steps(step, speed)
        if explicit_steps > self.cost and self._possible:
            self._take(self.stiff, 0.0, f"a mode at {abs(speed):.3g}/s makes the scene stiff")
        elif self._possible and self._dies_out(values) and self._steps(self._end, speed) > self.least_run * self.cost:
            self._take(self.stiff, 0.0, f"a decay at {abs(speed):.3g}/s is over long before the end of the run")
        elif explicit_steps > 1.0:
            self._take(self.explicit, 0.0, f"a mode at {abs(speed):.3g}/s makes it but mildly stiff")
        else:
            self._take(self.explicit, 0.0, "no mode makes the start stiff")

    def look(self, t: float, y: Floats, step: float, steps: int) -> bool:
        """Whether to switch at t [s], after ``steps`` steps; ``step`` [s] is the next to try."""
        mean = (t - self._since) / max(1, steps)
        self._since = t
        if self._local and self.active is self.stiff and mean < self._held and self._early < EARLY:
            self._leave(t, mean / self._held)
            return True
        if self._early:
            self._early -= 1
            if self._early == EARLY // 2:
                self._warm = t
            if self._early:
                return False
            mean, steps, self._warming = (t - self._warm) / TRIAL, TRIAL, False
        if self._warming:
            self._warming = False
            return False
        self._between = min(LAST, 2 * self._between)
        self.until_look = self._between if self.active is self.explicit else min(self._between, self._often)
        if self.active is self.explicit:
            held = min(step, mean)
            left = (self._end - t) / held if held > 0.0 else math.inf
            if not self._possible or not self.switching <= left < math.inf:
                return False
            part = DECAYED if 5 * (self.switching + 2 * TRIAL * self.cost) < left else HELD
            values = self._spectrum(t, y, part * least_boundary(self.explicit.method.stability) / held)
            speed = dominant(values)
            if self._steps(held, speed) < (part if self._dies_out(values) else HELD):
                return False
            part = self._steps(held, speed)
            self._proven = part >= HELD
            self._part = 1.0 if self._proven else part
            self._held = held
            self._take(self.stiff, t, f"a mode at {abs(speed):.3g}/s holds the steps, not the tolerance")
            return True
        gain = self._steps(mean, dominant(self._spectrum(t, y))) / self._part
        self._lost = max(0.0, self._lost + steps * (self.cost - gain))
        if gain >= PATIENCE * self.cost:
            self._in_vain, self._proven = 0, True
            return False
        if self._proven and self._lost < self._kept:
            return False
        self._leave(t, gain)
        return True

    def give_up(self, t: float) -> bool:
        """Whether the explicit method takes over from a stiff one that finds no step short enough at t [s].

        Where friction reverses, a rate jumps: its Jacobian is then useless, however short the step.
        """
        if self.active is self.explicit:
            return False
        self._since = t
        self._take(self.explicit, t, f"{self.stiff.method.name} finds no step short enough where the rate jumps")
        self._wait()
        return True

    def _leave(self, t: float, gain: float) -> None:
        """Go on with the explicit method; ``gain``: explicit steps that a stiff one replaces."""
        self._take(self.explicit, t, f"a stiff step replaces but {gain:.2g} explicit ones and costs {self.cost:.2g}")
        self._wait()

    def _wait(self) -> None:
        """Wait in proportion to a trial's cost, twice as long after each in vain; it may soon be stiff again."""
        self._between = FIRST
        self.until_look = max(FIRST, int(TRIAL * self.cost)) << self._in_vain
        self._in_vain = min(self._in_vain + 1, 5)

    def refuse(self, t: float, why: str) -> None:
        """Exclude the stiff method, which cannot solve this island: the explicit one continues to the end."""
        self._possible = False
        self._take(self.explicit, t, why)

    def stable(self, t: float, y: Floats, step: float) -> float:
        """``step`` [s], or the largest stable step of the active method if that is shorter."""
        steps = self._steps(step, dominant(self._spectrum(t, y))) if self.active is self.explicit else 0.0
        return step * min(1.0, HELD / steps) if steps else step

    def _spectrum(self, t: float, y: Floats, negligible: float = 0.0) -> Complexes:
        return spectrum(self._rate_at, self._partner, t, y, negligible)

    def _steps(self, length: float, speed: complex) -> float:
        """Number of largest stable explicit steps in a length [s], for a mode of eigenvalue ``speed`` [1/s]."""
        return length * abs(speed) / boundary(self.explicit.method.stability, speed) if speed else 0.0

    def _take(self, stepper: Stepper, t: float, why: str) -> None:
        self.active = stepper
        self._warming = stepper is self.stiff
        self._early = EARLY if self._warming and self._local and self._held else 0
        self._lost = 0.0
        if self._warming:
            self.until_look = 2 * TRIAL // EARLY if self._early else TRIAL
        self.history.append((t, f"{stepper.method.name}: {why}"))
