"""The march of static equilibria, each at the loads of its instant."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import sceneql.system.channels as channels
from sceneql.failure import LimitRefused, RunFailure
from sceneql.island import layout
from sceneql.march import march_kernels as kernels
from sceneql.march.march import March
from sceneql.stepping.equilibrium_kernels import ENDED, ON_THE_WAY, PROGRESS, REACHED, UNSTABLE, relax

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.march.pace import Pace

MOTIONS = ("move along x", "move along y", "move along z", "turn about x", "turn about y", "turn about z")
FREE = 1e-7
"""Stiffness against a rigid motion, relative to the largest stiffness, below which the motion counts as free."""
MOVED = 1e-6
"""Displacement of a model, relative to its size, by which that stiffness is measured."""
JUMPED = 1e-6
"""Force on the former equilibrium, relative to the largest load, from which on the loads have jumped."""
SHAKEN = 1e-8
"""Random displacement of a model, relative to its size, that tells forces after a jump of the loads from the residual
of Newton's method."""
LEAPT = 1e-9
"""Distance between the place that is prescribed and the present one, relative to the largest coordinate, from which on
a prescribed position jumps."""


class EquilibriumMarch(March):
    """Finds the equilibrium at the start, then follows it through the run."""

    _asked = float("inf")
    """The instant [s] that was asked for: no step goes beyond it."""

    def _start(self) -> None:
        """Find the first equilibrium.

        Raises LimitRefused where nothing holds a model, RunFailure where there is no equilibrium.
        """
        self.floats[channels.STATIC] = channels.RESTING
        super()._start()
        self._refuse_free_motions()
        self._relax(0.0)

    def _relax(self, t: float) -> None:
        grown = True
        while grown:
            y, progress, found = self._y1.copy(), np.zeros(PROGRESS), ON_THE_WAY
            memory = progress, self._work, self._settings, self._numbers, self.floats, self.system.ints
            while found == ON_THE_WAY:
                found = relax(self._engaged.functions, t, y, *memory)
            grown = self.floats[channels.GROWS] != 0.0 and self._grow()
        if found == UNSTABLE:
            raise self._failure("the rest that was found is unstable: the least push would leave it")
        if found != REACHED:
            rubs = "; where solids touch friction does not act at rest" if self.system.structure.limits else ""
            raise self._failure(f"no rest was found: forces have none, or move on without end{rubs}")
        self._y0[:] = self._y1[:] = y  # an instant that is asked for may lie an ulp before this one
        self._rate0[:] = self._rate1[:] = self.rate(t, y)

    def _march(self, target: float, pace: Pace) -> None:
        """March to an instant; steps end at the instants that are asked for."""
        self._asked = target
        self._step_end = min(self._step_end, target)
        super()._march(target, pace)
        self._asked = float("inf")
        self._look_for_breakpoint(self.time)

    def _look_for_breakpoint(self, time: float) -> None:
        super()._look_for_breakpoint(time)
        self._step_end = min(self._step_end, self._asked)

    def _pass_breakpoint(self) -> None:
        super()._pass_breakpoint()
        if self._leaps(self.time):
            self._relax(self.time)

    def _leaps(self, t: float) -> bool:
        """Whether prescribed positions at an instant [s] differ by a jump from the present ones."""
        self.floats[channels.STATIC] = channels.PLACING
        off = self.rate(t, self._y1)
        self.floats[channels.STATIC] = channels.RESTING
        self._floats_time = np.nan
        placed = self.system.partner >= 0
        return bool(np.abs(off[placed]).max(initial=0.0) > LEAPT * np.abs(self._y1[placed]).max(initial=0.0))

    def _goes_on(self, status: int) -> bool:
        """Whether the march continues: where loads have jumped, a new equilibrium is found.

        Raises RunFailure where the path of equilibria has turned back (a limit load), or where they become unstable.
        """
        if status != kernels.STEP_TOO_SMALL:
            return False
        t = self.time
        after = t + 4.0 * float(np.spacing(t))
        left = np.abs(self._forces(after, self._y1)).max(initial=0.0)
        if self._leaps(after) or left > max(JUMPED * max(self._load(t), self._load(after)), self._shaken(after)):
            self._clock[kernels.T1] = after
            self._relax(after)
            return True
        if self._settings[ENDED] == UNSTABLE:
            raise self._failure("a rest beyond this is unstable, as of a column that buckles", t)
        raise self._failure("a limit load is reached: no rest beyond it is near", t)

    def _failure(self, message: str, t: float = 0.0) -> RunFailure:
        """The failure with a message, at the entry of the largest force."""
        forces = np.abs(self._forces(t, self._y1))
        origin = self.system.origin(int(forces.argmax()) if len(forces) else 0)
        return RunFailure(f"{message} (loads of {self._load(t):.6g} N)", part=origin.part, time=t, span=origin.span)

    def _forces(self, t: float, y: Floats) -> Floats:
        """(n,) forces on masses that move [N], 0 for other entries."""
        found = np.zeros(len(y))
        rate = self.rate(t, y)
        for velocity_at, inverse_at, count in self.system.masses:
            mine = slice(velocity_at, velocity_at + 3 * count)
            inverse = np.repeat(self.floats[inverse_at : inverse_at + count], 3)
            np.divide(rate[mine], inverse, out=found[mine], where=inverse > 0.0)
        return found

    def _load(self, t: float) -> float:
        """The load: sum of the magnitudes of forces on masses by other parts than their models [N]."""
        system, ints, floats = self.system, self.system.ints.copy(), self.floats.copy()
        firsts = ints[layout.GROUPS_AT : layout.GROUPS_AT + len(system.structure.terms) + 1].copy()
        models = {part for _, _, part, _ in system.ranges}
        before, total = np.zeros(len(system.y)), np.zeros(len(system.y))
        for count, term in enumerate(system.terms, 1):
            ints[layout.GROUPS_AT : layout.GROUPS_AT + len(firsts)] = np.minimum(firsts, firsts[0] + count)
            rate = np.empty_like(before)
            self.driver.rate(t, self._y1, rate, floats, ints)
            if term.part not in models:
                total += rate - before
            before = rate
        parts = [total[at : at + 3 * count].reshape(-1, 3) for at, _, count in system.masses]
        moving = [self.floats[inverse_at : inverse_at + count] > 0.0 for _, inverse_at, count in system.masses]
        return float(sum(np.linalg.norm(each[free], axis=1).sum() for each, free in zip(parts, moving, strict=True)))

    def _position_of(self) -> Any:
        """(n,) for the velocity of a position the index of the position, -1 for other entries."""
        found = np.full(len(self.system.y), -1)
        paired = np.flatnonzero(self.system.partner >= 0)
        found[self.system.partner[paired]] = paired
        return found

    def _shaken(self, t: float) -> float:
        """The largest change of a force as masses are displaced at random by SHAKEN of their model's size [N].

        Where held places alone load a solid, this tells the residual of Newton's method from a load that has jumped.
        """
        y, some = self._y1.copy(), np.random.Generator(np.random.Philox(1))
        position_of = self._position_of()
        for velocity_at, _, count in self.system.masses:
            places = position_of[velocity_at : velocity_at + 3 * count]
            size = float(np.ptp(y[places].reshape(-1, 3), axis=0).max(initial=0.0))
            y[places] += SHAKEN * size * some.standard_normal(3 * count)
        return float(np.abs(self._forces(t, y) - self._forces(t, self._y1)).max(initial=0.0))

    def _refuse_free_motions(self) -> None:
        """Raise LimitRefused for models that may be moved as rigid bodies without resistance."""
        system = self.system
        position_of = self._position_of()
        if not system.masses:
            part, span = system.ranges[0][2], system.ranges[0][3][0]
            raise LimitRefused(f"rest is found of masses, and '{part}' has none", span, "let auto march it")
        some = np.random.Generator(np.random.Philox(1))
        for velocity_at, inverse_at, count in system.masses:
            places = position_of[velocity_at : velocity_at + 3 * count]
            if not (self.floats[inverse_at : inverse_at + count] > 0.0).all():
                continue
            at = self._y1[places].reshape(-1, 3)
            size = max(float(np.ptp(at, axis=0).max()), 1.0)
            random = some.standard_normal(at.shape)
            shaken = at + 0.01 * size * some.standard_normal(at.shape)
            response = self._resisted(places, at, random, size)
            scale = np.abs(response).max()
            led = self._led(places, at, response[velocity_at : velocity_at + 3 * count] == 0.0, size)
            free: list[str] = []
            for k, name in enumerate(MOTIONS):
                axis = np.eye(3)[k % 3]
                motion = np.tile(axis, (count, 1)) if k < 3 else np.cross(axis, at - at.mean(axis=0))
                if k >= 3 and (len(free) < 3 or not motion.any()):
                    continue
                if np.abs(motion.ravel()[led]).max(initial=0.0) > FREE * size:
                    continue  # it would move what is held
                resisted = np.abs(self._resisted(places, shaken if k < 3 else at, motion, size)).max()
                if resisted <= FREE * scale:
                    free.append(name)
            if free:
                origin = system.origin(velocity_at)
                raise LimitRefused(
                    f"nothing holds '{origin.part}': it is free to {', '.join(free)}",
                    origin.span,
                    "fix some of its masses, or let `auto` march it in time",
                )

    def _led(self, places: Any, at: Floats, numb: Any, size: float) -> Any:
        """(3 n,) bool: the components ``numb``, which feel no force, if forces on others depend on them; else none."""
        motion = np.where(numb, 1.0, 0.0).reshape(at.shape)
        felt = numb.any() and np.abs(self._resisted(places, at, motion, size)).max() > 0.0
        return numb if felt else np.zeros_like(numb)

    def _resisted(self, places: Any, at: Floats, motion: Floats, size: float) -> Floats:
        """(n,) change of all forces [N] by a motion of masses from ``at``, by central differences."""
        ends = []
        for sign in (1.0, -1.0):
            y = self._y1.copy()
            y[places] = (at + sign * MOVED * size * motion).ravel()
            ends.append(self._forces(0.0, y))
        return ends[0] - ends[1]
