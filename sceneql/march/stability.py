"""The largest stable step of a solver on an assembled island, with the part and line of the script that limits it.

The rate is linearized at the start of the run, and the solver's growth factor is evaluated on each mode of the Jacobian
as a small system (mode_blocks.py). A mode's own growth belongs to the scene and does not count as instability.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.kinds.stable_step import LEAST, MOST, NEUTRAL, first_unstable
from sceneql.march.mode_blocks import Block, alone, paired, uses_pairs
from sceneql.march.modes import Modes, jacobian, modes_of
from sceneql.stepping.tableau import CLASSIC

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats
    from sceneql.kinds import Solver
    from sceneql.march.march import March
    from sceneql.quantities.span import Span

WHOLE = 200
"""Largest number of entries of y for which methods that use pairs are tested on the whole Jacobian, where modes are not
pure oscillations."""


@dataclass(frozen=True, slots=True)
class Stability:
    """The stability of a solver's step on an island, known before the run."""

    step: float
    """Largest stable step [s]; 0: none is; inf: any is."""
    growth: float
    """Growth factor of the worst mode in a step of the script's own length; 1 for adaptive methods."""
    frequency: float
    """|lambda|/(2 pi) of the mode that sets the bound [1/s]."""
    part: str
    span: Span | None
    text: str


def stability(march: March, solver: Solver) -> Stability:
    """The stable step of ``solver`` on the island of ``march`` at its start."""
    system, control = march.system, march.stepper.control
    modes = modes_of(march)
    if modes is None:
        return Stability(math.inf, 1.0, 0.0, "", None, "any step is stable: at the start no rate depends on the state")
    fastest = modes.fastest
    by_pairs = uses_pairs(solver)
    simple = [alone(value / fastest) for value in modes.values]
    blocks = paired(march, modes) if by_pairs else simple
    reduced = _Reduced(solver.growth, blocks)
    bound = reduced.bound()
    if 0 < bound < math.inf and by_pairs and len(system.y) <= WHOLE and _mixed(modes):
        bound = _whole(march, solver, bound / fastest, max(0.0, float(modes.values.real.max()))) * fastest
    script = 0.0 if control.adaptive else control.first_step
    tried = script * fastest if script else 1e-2
    if 0 < bound < math.inf and tried <= bound:
        tried = 1.02 * bound
    growths = [reduced.growth_of(block, tried) for block in blocks]
    worst = int(np.argmax(growths))
    origin = system.origin(modes.leading(worst, system.partner))
    frequency = float(np.abs(np.linalg.eigvals(blocks[worst].jacobian)).max()) * fastest / (2 * math.pi)
    growth = max(reduced.growth_of(block, script * fastest) for block in blocks) if script else 1.0
    mode = _told(complex(modes.values[worst]), frequency, origin.part) + (f" ({origin.span})" if origin.span else "")
    step = bound / fastest
    text = _text(step, script, growth, mode, control.adaptive)
    if control.adaptive or math.isinf(bound):
        text += _yardstick(simple, fastest)
    return Stability(step, growth, frequency, origin.part, origin.span, text)


def _told(value: complex, frequency: float, part: str) -> str:
    """Description of a mode: the frequency [Hz] of an oscillation, the rate of a decay or growth."""
    if abs(value.imag) > NEUTRAL * abs(value.real):
        return f"a mode of '{part}' at {frequency:.4g} Hz"
    return f"a {'growth' if value.real > 0 else 'decay'} of '{part}' at {2 * math.pi * frequency:.4g}/s"


def _yardstick(blocks: list[Block], fastest: float) -> str:
    """The stable step of rk4 as a text, for comparison."""
    bound = _Reduced(lambda jacobian, partner, step: CLASSIC.growth(jacobian, step), blocks).bound() / fastest
    return f"; rk4 would need steps of at most {bound:.4g} s" if 0 < bound < math.inf else ""


def _text(bound: float, script: float, growth: float, mode: str, adaptive: bool) -> str:
    if math.isinf(bound):
        return "any step is stable"
    if bound == 0.0:
        own = f"; a step of {script:.4g} s multiplies it by {growth:.6g}" if script else ""
        return f"no step is stable: {mode} grows under this method at every step{own}"
    limit = f"stable up to a step of {bound:.4g} s, set by {mode}"
    if adaptive:
        return limit + "; the tolerance keeps the steps there"
    if script > bound:
        return f"unstable: the step of {script:.4g} s exceeds {bound:.4g} s, set by {mode}; growth {growth:.4g} a step"
    return limit


@dataclass(frozen=True)
class _Reduced:
    """Stability on single modes, time scaled so that the fastest has frequency 1."""

    growth: Callable[[Floats, Any, float], float]
    """A solver's growth function (kinds.Solver.growth)."""
    blocks: list[Block]

    def growth_of(self, block: Block, step: float) -> float:
        """Growth factor of a step beyond the mode's own growth."""
        return self.growth(block.jacobian, block.partner, step) * math.exp(-block.own * step)

    def bound(self) -> float:
        """Largest stable scaled step; 0 where it is below 100 LEAST, where rounding alone makes a step look stable."""
        sharp = self._bound(NEUTRAL)
        if sharp < 100 * LEAST or self._bound(NEUTRAL / 100) < 0.8 * sharp:
            return 0.0
        return sharp

    def _bound(self, neutral: float) -> float:
        """The bound of the fastest mode, lowered by each mode that is unstable at it."""
        asked = {max(range(len(self.blocks)), key=lambda k: float(np.abs(self.blocks[k].jacobian).max()))}
        while True:

            def holds(k: int, step: float) -> bool:
                return self.growth_of(self.blocks[k], step) <= 1.0 + 1e-14 + neutral * step

            bound = first_unstable(lambda step: all(holds(k, step) for k in asked))
            at = 0.999 * min(bound, MOST)
            more = [k for k in range(len(self.blocks)) if k not in asked and not holds(k, at)]
            if not more or bound == 0.0:
                return bound
            asked.add(max(more, key=lambda k: self.growth_of(self.blocks[k], at)))


def _mixed(modes: Modes) -> bool:
    """Whether relevant modes are damped, so that pairs couple them, and none grows by itself and hides their bound."""
    rates = modes.values.real / modes.fastest
    return bool(rates.min() < -1e-3 and rates.max() < 1e-3)


def _whole(march: March, solver: Solver, guess: float, own: float) -> float:
    """The largest stable step [s] by the whole Jacobian, searched from ``guess``.

    ``own`` [1/s]: the modes' own growth.
    """
    matrix, partner = jacobian(march), march.system.partner

    def stable(step: float) -> bool:
        return solver.growth(matrix, partner, step) <= (1.0 + 1e-6) * math.exp(own * step)

    low = guess
    while not stable(low):
        low *= 0.7
        if low < 1e-3 * guess:
            return guess
    high = low
    while stable(high) and high < 100 * guess:
        low, high = high, high * 1.3
    while high - low > 1e-3 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low
