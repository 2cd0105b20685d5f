"""Which of two methods marches an island, an explicit or a stiff one: decided at the start and looked at again.

An explicit step is held by stability, not by the tolerance, where its length times the fastest mode stands at the
boundary of its stability region (Hairer & Wanner 1996, IV.2). Then a stiff method is tried, and kept as long as its
steps replace more explicit ones than they cost. All is decided by counts of steps and operations, never by a clock.
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
"""Part of the stability boundary from which on a step counts as held by it."""
FIRST, LAST = 200, 6400
"""Steps up to the first look, and at most between two."""
TRIAL = 100
"""Steps of a stiff method after which it is looked at first, and after which it is first judged."""
PATIENCE = 1 / 3
"""Part of its cost that a stiff step has to replace: vibrations that its start excites take it some time to damp."""


class Switch:
    """The choice for one march."""

    def __init__(self, explicit: Stepper, stiff: Stepper, rate_at: Rate, partner: Partners) -> None:
        """``rate_at``, ``partner``: of the island, see `dominant`."""
        self.explicit, self.stiff = explicit, stiff
        self._rate_at, self._partner = rate_at, partner
        self.size = int((partner < 0).sum())
        """Unknowns of the stiff method's linear systems."""
        self.active = explicit
        self.history: list[tuple[float, str]] = []
        """When [s] which method was taken, and why."""
        self.until_look = self._between = FIRST
        self._since = 0.0
        self._warming = False
        self._possible = self.size <= LARGEST

    @property
    def cost(self) -> float:
        """Explicit steps that one stiff step costs."""
        return step_cost(self.size)

    @property
    def _often(self) -> int:
        """Stiff steps between two looks: as many as cost what the most of explicit ones do."""
        return max(TRIAL, int(LAST / self.cost))

    def start(self, y: Floats, step: float) -> None:
        """Choose the method to begin with; ``step`` [s]: what the tolerance seems to allow at the start."""
        speed = self._fastest(0.0, y)
        explicit_steps = self._steps(step, speed)
        if explicit_steps > self.cost and self._possible:
            self._take(self.stiff, 0.0, f"a mode at {abs(speed):.3g}/s makes the scene stiff")
        elif explicit_steps > 1.0:
            self._take(self.explicit, 0.0, f"a mode at {abs(speed):.3g}/s makes it but mildly stiff")
        else:
            self._take(self.explicit, 0.0, "no mode makes the start stiff")

    def look(self, t: float, y: Floats, step: float, steps: int) -> bool:
        """Whether the other method is taken from t [s] on, with ``step`` to try next, after so many steps."""
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
        # A trial in vain is not to cost more than what it is between.
        self.until_look = max(self.until_look, int(TRIAL * self.cost))
        return True

    def give_up(self, t: float) -> bool:
        """Whether the explicit method takes over from a stiff one that finds no step short enough at t [s].

        Where friction turns, a rate jumps: its Jacobian then says nothing, however short the step.
        """
        if self.active is self.explicit:
            return False
        self._since = t
        self._take(self.explicit, t, f"{self.stiff.method.name} finds no step short enough where the rate jumps")
        return True

    def refuse(self, t: float, why: str) -> None:
        """The stiff method cannot take this island: the explicit one goes on to the end."""
        self._possible = False
        self._take(self.explicit, t, why)

    def stable(self, t: float, y: Floats, step: float) -> float:
        """The step [s], or what of it the active method can take."""
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
