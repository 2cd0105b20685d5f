"""spring: a spring between masses of different models, or from a mass to a place."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

from sceneql.bodies.time_shift import rate_of_change
from sceneql.island.static_rates import On, number
from sceneql.kinds import Damping, FixedLength, Force, Position, Problem, Stiffness, Value, field
from sceneql.kinds.stable_step import Oscillation
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Link

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.system import Assembly, Bodies, ModelState, Slopes


class Spring(Force):
    """A spring between two places: F = stiffness (l - rest) + damping dl/dt along it (Hooke 1678).

    ``from`` and ``to`` are positions of masses, as `cage.corner.position`, of any models; one of them may be a place of
    its own, that of a `motion` too. Half of its energy belongs to each mass; all of it to the only one. The models are
    solved together. What the damping takes is counted as dissipated, less what moves the place gives. The velocity of
    a place is the central difference over 0.2 ms.
    """

    mutual: ClassVar[bool] = True

    from_: Position = field("The position of a mass, or a place.")
    to: Position = field("The position of a mass, or a place.")
    stiffness: Stiffness = field("Force for a stretch.", "100 N/m", at_least=0)
    damping: Damping = field("Force for a speed of stretching.", "0 N*s/m", at_least=0)
    rest: FixedLength | None = field("Length without force; by default that at the start.", None, at_least=0)

    def problems(self) -> Iterator[Problem]:
        """Two ends without a mass."""
        if not self.targets():
            yield Problem("a spring needs a mass at one of its ends, as `from: cage.corner.position`")

    def targets(self) -> tuple[str, ...]:
        """The models of the masses at its ends."""
        links = (end.expr for end in (self.from_, self.to))
        return tuple(dict.fromkeys(link.task for link in links if isinstance(link, Link)))

    def internal(self) -> bool:
        """Where there is a mass at both of its ends."""
        return all(isinstance(end.expr, Link) for end in (self.from_, self.to))

    def fastest(self, name: str, on: On) -> Iterator[Oscillation]:
        """The spring with the masses at its ends."""
        inverses = [self._inverse(end, on) for end in (self.from_, self.to)]
        stiffness, damping = number(self.stiffness), number(self.damping)
        if None not in (*inverses, stiffness, damping):
            inverse = sum(each or 0.0 for each in inverses)
            yield Oscillation(math.sqrt(stiffness * inverse), damping * inverse, f"force '{name}'", ("stiffness",))

    def _inverse(self, end: Value, on: On) -> float | None:
        """1/mass [1/kg] at an end, 0 of a place of its own; None where that is not told."""
        if not isinstance(end.expr, Link) or end.expr.task not in on:
            return 0.0
        masses = on[end.expr.task]
        which = end.expr.output.rpartition(".")[0]
        return masses[which].inverse if which in masses else None

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add the spring. Raises ScriptError where an end is computed of masses but is none."""
        import numpy as np

        ends = [self._end(value, assembly, everyone) for value in (self.from_, self.to)]
        span = self.from_.span
        if ends[0][0] == ends[1][0] >= 0:
            raise ScriptError([Diagnostic("same-mass", "a spring leads from a mass to itself", self.to.span or span)])
        if max(end[0] for end in ends) < 0:
            raise ScriptError([Diagnostic("no-mass", "a spring needs a mass at one of its ends", span)])
        length = float(np.linalg.norm(np.subtract(assembly.initial(self.to), assembly.initial(self.from_))))
        rest = assembly.floats([length if self.rest is None else self.rest])
        values = (assembly.value(self.stiffness), assembly.value(self.damping), rest)
        speeds = (self._speed(end[0], value, assembly) for end, value in zip(ends, (self.from_, self.to), strict=True))
        ints = (*ends[0][:3], *ends[1][:3], *values, *speeds)
        more = (*ints, ends[0][3], ends[1][3])
        assembly.term("force", "sceneql.words.forces.spring_kernels:spring", ints, lambda: _slopes(ends, more))
        assembly.remember(*ints)

    def _end(self, value: Value, assembly: Assembly, everyone: Sequence[Bodies]) -> tuple[int, int, int, int]:
        """Offsets of position and velocity in y, of the work, of the inverse mass; or -1, the place's, -1, -1."""
        link = value.expr if isinstance(value.expr, Link) and assembly.formula(value.expr) is None else None
        places = None if link is None else assembly.places(link)
        if places is not None:
            at = int(places[0])
            for bodies in everyone:
                if bodies.position_at <= at < bodies.position_at + 3 * bodies.count:
                    moved = at - bodies.position_at
                    return at, bodies.velocity_at + moved, bodies.work_at, bodies.inverse_at + moved // 3
        return -1, assembly.value(value), -1, -1

    def _speed(self, mass_at: int, value: Value, assembly: Assembly) -> int:
        """Offset of the velocity of a place, -1 of a mass. Raises ScriptError where a damped one's is not known."""
        if mass_at >= 0:
            return -1
        if value.constant:
            return assembly.floats([0.0, 0.0, 0.0])
        try:
            return assembly.value(Value(rate_of_change(value.expr, assembly.formula), value.span))
        except ValueError as error:
            if number(self.damping) == 0.0:
                return assembly.floats([0.0, 0.0, 0.0])
            message = f"a damped spring needs to know how fast its ends move: {error}"
            raise ScriptError([Diagnostic("no-velocity", message, value.span)]) from None

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Half stiffness stretch^2 [J], the part of this model's masses."""
        import numpy as np

        ends = (state.ints[0:3], state.ints[3:6])
        places = [state.y[at : at + 3] if at >= 0 else state.floats[other : other + 3] for at, other, _ in ends]
        stretch = float(np.linalg.norm(places[1] - places[0])) - state.floats[state.ints[8]]
        owned = sum(work == bodies.work_at for _, _, work in ends) / sum(work >= 0 for _, _, work in ends)
        return float(0.5 * state.floats[state.ints[6]] * stretch**2 * owned)


def _slopes(ends: Sequence[tuple[int, int, int, int]], ints: Sequence[int]) -> Slopes:
    """Where the blocks of the derivatives stand: see spring_slopes_kernels."""
    import numpy as np

    from sceneql.system import Slopes

    i, j = np.divmod(np.arange(9), 3)
    masses = [end for end in ends if end[0] >= 0]
    pairs = [(one[1], other[which]) for one in masses for which in (0, 1) for other in masses]
    rows, columns = (np.concatenate(places) for places in zip(*((r + i, c + j) for r, c in pairs), strict=True))
    return Slopes("sceneql.words.forces.spring_slopes_kernels:spring", rows, columns, ints)
