"""The switch between an explicit and a stiff method on an island: chosen at the start, reconsidered during the run.

An explicit step is limited by stability, not by the tolerance, where its length times the fastest mode lies at the
boundary of its stability region (Hairer & Wanner 1996, IV.2). Then a stiff method is tried, and kept as long as its
steps replace more explicit ones than they cost. Costs are counts of steps and operations, never times of a clock.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.march.spectrum import boundary, dominant
from sceneql.stepping.radau_systems import LARGEST, step_cost

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.march.spectrum import Partners, Rate
    from sceneql.system import Stepper

HELD = 0.5
"""Part of the stability boundary from which on stability counts as limiting the step."""
FIRST, LAST = 200, 6400
"""Explicit steps before the first check, and at most between two checks."""
STAGES = 7
"""Stages of dopri5, in whose steps costs are measured."""
TRIAL = 100
"""Steps of a stiff method before a mean step length is measured, and again until it is first judged by that."""
PATIENCE = 1 / 3
"""Part of its cost that a stiff step has to replace: vibrations excited at its start take some time to damp."""


class Switch:
    """The choice of the method of one march."""

    def __init__(self, explicit: Stepper, stiff: Stepper, rate_at: Rate, partner: Partners) -> None:
        """``rate_at``, ``partner``: the island's, see `dominant`."""
        self.explicit, self.stiff = explicit, stiff
        self._rate_at, self._partner = rate_at, partner
        self.size = int((partner < 0).sum())
        """Unknowns of the stiff method's linear systems."""
        self.active = explicit
        self.history: list[tuple[float, str]] = []
        """(time [s], method and reason) of each choice."""
        self.until_look = self._between = FIRST
        self._since = 0.0
        self._warming = False
        self._possible = self.size <= LARGEST

    @property
    def cost(self) -> float:
        """Explicit steps that one stiff step costs."""
        return step_cost(self.size) * STAGES / (len(self.explicit.method.stability) - 1)

    @property
    def _often(self) -> int:
        """Stiff steps between two checks: as many as cost LAST explicit ones."""
        return max(TRIAL, int(LAST / self.cost))

    def start(self, y: Floats, step: float) -> None:
        """Choose the first method; ``step`` [s]: an estimate of the step that the tolerance allows at the start."""
        speed = self._fastest(0.0, y)
        explicit_steps = self._steps(step, speed)
        if explicit_steps > self.cost and self._possible:
            self._take(self.stiff, 0.0, f"a mode at {abs(speed):.3g}/s makes the scene stiff")
        elif explicit_steps > 1.0:
            self._take(self.explicit, 0.0, f"a mode at {abs(speed):.3g}/s makes it but mildly stiff")
        else:
            self._take(self.explicit, 0.0, "no mode makes the start stiff")

    def look(self, t: float, y: Floats, step: float, steps: int) -> bool:
        """Whether to switch at t [s], after ``steps`` steps; ``step`` [s] is the next to try."""
        mean = (t - self._since) / max(1, steps)
        self._since = t
        if self._warming:
            self._warming = False
            return False
        self._between = min(LAST, 2 * self._between)
        self.until_look = self._between if self.active is self.explicit else min(self._between, self._often)
        speed = self._fastest(t, y)
        if self.active is self.explicit:
            if not self._possible or self._steps(min(step, mean), speed) < HELD:
                return False
            self._take(self.stiff, t, f"a mode at {abs(speed):.3g}/s holds the steps, not the tolerance")
            return True
        gain = self._steps(mean, speed)
        if gain >= PATIENCE * self.cost:
            return False
        self._take(self.explicit, t, f"a stiff step replaces but {gain:.2g} explicit ones and costs {self.cost:.2g}")
        # A trial in vain must not cost more than the steps before the next one; it may soon be stiff again.
        self._between = FIRST
        self.until_look = max(FIRST, int(TRIAL * self.cost))
        return True

    def give_up(self, t: float) -> bool:
        """Whether the explicit method takes over from a stiff one that finds no step short enough at t [s].

        Where friction reverses, a rate jumps: its Jacobian is then useless, however short the step.
        """
        if self.active is self.explicit:
            return False
        self._since = t
        self._take(self.explicit, t, f"{self.stiff.method.name} finds no step short enough where the rate jumps")
        return True

    def refuse(self, t: float, why: str) -> None:
        """Exclude the stiff method, which cannot solve this island: the explicit one continues to the end."""
        self._possible = False
        self._take(self.explicit, t, why)

    def stable(self, t: float, y: Floats, step: float) -> float:
        """``step`` [s], or the largest stable step of the active method if that is shorter."""
        steps = self._steps(step, self._fastest(t, y)) if self.active is self.explicit else 0.0
        return step * min(1.0, HELD / steps) if steps else step

    def _fastest(self, t: float, y: Floats) -> complex:
        return dominant(self._rate_at, self._partner, t, y)

    def _steps(self, length: float, speed: complex) -> float:
        """Stable explicit steps in a length [s]."""
        return length * abs(speed) / boundary(self.explicit.method.stability, speed) if speed else 0.0

    def _take(self, stepper: Stepper, t: float, why: str) -> None:
        self.active = stepper
        self._warming = stepper is self.stiff
        if self._warming:
            self.until_look = TRIAL
        self.history.append((t, f"{stepper.method.name}: {why}"))
