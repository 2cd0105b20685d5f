"""The march of masses by the lowest modes of their linear motion about rest, exact in time."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.compiled.pointers_kernels import addresses
from sceneql.failure import LimitRefused, RunFailure
from sceneql.island.breakpoint_table import next_breakpoint
from sceneql.march.driver import jacobian
from sceneql.march.march import March
from sceneql.march.mode_loads import FIRST, Modes, Piece, next_piece
from sceneql.march.tangent import tangent
from sceneql.stepping.eigenmodes import lowest

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper

LOOKED_AT = (0.0, 0.0837, 0.2113, 0.3819, 0.5279, 0.6937, 0.8461, 1.0)
"""Instants, relative to the run, at which stiffness is compared where values vary in time: it must be the same."""
COUPLED = 1e-6
"""Damping between modes, relative to their own, from which on modes count as coupled."""


class ModalMarch(March):
    """Integrates each mode by itself, x = rest + sum of q s, without steps, under piecewise polynomial loads."""

    def _engage(self, stepper: Stepper) -> None:
        """Find the modes.

        Raises LimitRefused, at its line, for a part that is not in linear motion about rest.
        """
        system = self.system
        self._refuse()
        functions = addresses(None, None, *self.driver, jacobian(system), None, None, None)
        self._rest = system.y.copy()
        for at, values in system.rests:
            self._rest[at : at + len(values)] = values
        for at, _, count in system.masses:
            self._rest[at : at + 3 * count] = 0.0
        self._varies = self._varying()
        times = self.end * np.array(LOOKED_AT if self._varies else LOOKED_AT[:1])
        found = tangent(self, functions, self._rest, times)
        count = int(stepper.method.numbers[0])
        points = np.stack([self._rest[found.positions - found.axes + k] for k in range(3)], axis=1)
        squares, self._shapes = lowest(found.stiffness, found.mass, count, points)
        self._found = found
        if (squares < 0.0).any():
            raise self._refusal("the rest is unstable: what grows there is no oscillation")
        damping = self._shapes.T @ (found.damping @ self._shapes)
        own = np.diag(damping)
        apart = damping - np.diag(own)
        if np.abs(apart).max(initial=0.0) > COUPLED * np.abs(own).max(initial=0.0):
            raise self._refusal(
                "its damping couples modes, which are then not apart: damping is as stiffness is, or as mass is"
            )
        self._modes = Modes(0.5 * own, squares)
        self._tallies = np.setdiff1d(np.arange(len(system.y)), self._known())
        if own.any() and len(self._tallies) > 1:
            raise self._refusal("it counts what damping takes out of one model, and here are several")
        self._project()
        self.prepared_text = self._told()

    def _varying(self) -> bool:
        """Whether loads vary in time: by values, at breakpoints, or by formulas, which differ at some instants."""
        if self.system.structure.varying or next_breakpoint(self.system.stops, 0.0, self.end) < self.end:
            return True
        first, *others = (self.rate(share * self.end, self._rest).copy() for share in LOOKED_AT)
        return any((first != one).any() for one in others)

    def _refuse(self) -> None:
        """Raise LimitRefused for islands that are not masses moved by forces."""
        system, structure = self.system, self.system.structure
        if not system.masses:
            raise self._refusal(f"modes are those of masses, and '{system.ranges[0][2]}' has none")
        if structure.after or structure.settling or structure.free or structure.tied:
            raise self._refusal("modes are those of masses that forces alone move: here something else moves or turns")
        missing = sorted(set(range(len(system.y))) - {*self._known().tolist(), *self._others()})
        if missing:
            part = system.origin(missing[0]).part
            raise self._refusal(f"modes are those of masses, and '{part}' has other numbers in its state", missing[0])

    def _others(self) -> list[int]:
        """Entries on which nothing depends: the tallies of energy."""
        return [] if self.system.pattern is None else self.system.pattern.tallies.tolist()

    def _known(self) -> Any:
        """Entries that are positions or velocities."""
        positions = np.flatnonzero(self.system.partner >= 0)
        return np.concatenate([positions, self.system.partner[positions]])

    def _refusal(self, message: str, index: int = 0) -> LimitRefused:
        return LimitRefused(message, self.system.origin(index).span, "let auto march it")

    def _project(self) -> None:
        """Project the initial state and the loads onto the modes."""
        found, shapes, system = self._found, self._shapes, self.system
        weighed = found.mass @ shapes
        start = system.y
        away = start[found.positions] - self._rest[found.positions]
        self._q = weighed.T @ away
        self._speed = weighed.T @ start[found.velocities]
        self._weighed = weighed
        self._time = 0.0
        self._uncounted: Floats | None = None
        forces = self._loads(0.0)
        self._piece: Piece | None = None if self._varies else Piece(0.0, self.end, forces[:, None])
        self._length = FIRST * self.end
        self._work = np.zeros(len(self._tallies))
        moving = found.mass @ start[found.velocities]
        strained = found.stiffness @ away
        self._energies = (
            0.5 * float(start[found.velocities] @ moving + away @ strained),
            0.5 * float(self._speed @ self._speed + self._modes.squares @ self._q**2),
        )

    def _loads(self, t: float) -> Floats:
        """(m (1 + tallies),) the loads on the modes at rest, then, for each tally, those whose work it counts."""
        rate = self.rate(t, self._rest)
        forces: Floats = self._weighed.T @ rate[self._found.velocities]
        if not len(self._tallies):
            return forces
        m = len(forces)
        if self._uncounted is not None:  # loads outside all tallies, such as weight, are mostly constant
            way = np.cos(1.0 + np.arange(m))
            guess = self._uncounted - forces
            counted = self._power(t, way)
            if abs(counted[0] - guess @ way) <= COUPLED * np.abs(guess * way).sum():
                return np.concatenate([forces, guess])
        own = np.array([self._power(t, one) for one in np.eye(m)]).reshape(m, -1).T
        if len(self._tallies) == 1:
            self._uncounted = forces + own[0]
        return np.concatenate([forces, *own])

    def _power(self, t: float, way: Floats) -> Floats:
        """(tallies,) power [W] of the loads at rest as modes move at speeds (m,): half the difference to -speeds."""
        ends = []
        for sign in (1.0, -1.0):
            y = self._rest.copy()
            y[self._found.velocities] = sign * (self._shapes @ way)
            ends.append(self.rate(t, y)[self._tallies])
        power: Floats = 0.5 * (ends[0] - ends[1])
        return power

    def _told(self) -> str:
        squares = self._modes.squares
        hertz = np.sqrt(squares) / (2.0 * np.pi)
        m, zeros = len(squares), int(np.count_nonzero(squares == 0.0))
        told = f"the linear motion about rest by its {m} lowest modes"
        if zeros:
            told += f", {zeros} of them free"
        if m > zeros:
            told += f", {hertz[zeros]:.4g} to {hertz[-1]:.4g} Hz"
        whole, kept = self._energies
        if whole > 0.0:
            told += f"; they have {100.0 * kept / whole:.3g} % of the energy at the start"
        return told

    def _reach(self, t: float) -> tuple[Floats, bool]:
        """The state at an instant."""
        if not self._started:
            self._start()
        started = time.perf_counter()
        m = len(self._q)
        while self._piece is None or t > self._piece.end:
            if self._piece is not None:
                if self._piece.end >= self.end:
                    break
                self._go(self._piece.end)
                self._length = 2.0 * (self._piece.end - self._piece.start)
            allowed, stops = self.stepper.control.tolerance, self.system.stops
            self._piece = next_piece(self._loads, self._time, self._length, stops, self.end, allowed)
            self.statistics.steps += 1
            if self._piece is None:
                origin = self.system.origin(0)
                message = "loads are not smooth: no polynomial in time is near them"
                raise RunFailure(message, part=origin.part, time=self._time, span=origin.span)
        self.statistics.steps = max(1, self.statistics.steps)
        q, speed, done = self._at(t)
        found, y = self._found, self._rest.copy()
        y[found.positions] += self._shapes @ q
        y[found.velocities] = self._shapes @ speed
        y[self._tallies] = done
        loads = self._piece.at(min(t, self.end))[:m, 0]
        self._pull = loads - 2.0 * self._modes.decays * speed - self._modes.squares * q
        self.statistics.seconds += time.perf_counter() - started
        return y, False

    def _at(self, t: float) -> tuple[Floats, Floats, Floats]:
        """q, q' (m,) and the tallies at an instant of the piece."""
        assert self._piece is not None
        m = len(self._q)
        h = t - self._time
        loads = self._piece.at(self._time)
        q, speed, integrals = self._modes.moved(self._q, self._speed, loads[:m], h)
        done = self._work.copy()
        if len(self._tallies):
            ends = self._piece.at(t)
            # The integral of f q' by parts: f q - f' Q + f'' QQ and so on, Q the integral of q from the beginning.
            works = ends[:, 0].reshape(-1, m) * q - loads[:, 0].reshape(-1, m) * self._q
            for k in range(1, loads.shape[1]):
                works += (-1.0) ** k * ends[:, k].reshape(-1, m) * integrals[:, k - 1]
            done += works[1:].sum(axis=1)
            if self._modes.decays.any():
                stored = 0.5 * (self._speed**2 + self._modes.squares * self._q**2).sum()
                done += stored - 0.5 * (speed**2 + self._modes.squares * q**2).sum() + works[0].sum()
        return q, speed, done

    def _go(self, t: float) -> None:
        self._q, self._speed, self._work = self._at(t)
        self._time = t

    def advance(self, t: float) -> tuple[Floats, Floats]:
        """State and rate (n,) at an instant [s]; accelerations are those of the linear motion."""
        y, _ = self._reach(min(t, self.end))
        rate = self.rate(min(t, self.end), y)
        rate[self._found.velocities] = self._shapes @ self._pull
        return y, rate

    view = advance
