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

    from sceneql.system import Assembly, Bodies, ModelState, Place, Slopes


OF_ELEMENTS = (
    "it holds one mass of a model, `cage.corner.position`; what pulls a solid of elements is among its `loads`:"
    " `loads: {tip: {near: 1 0 0 m, within: 5 cm, force: 0 -5 0 N}}`"
)
"""The help where neither end is a mass."""


class Spring(Force):
    """A spring between two places: F = stiffness (l - rest) + damping dl/dt along it (Hooke 1678).

    ``from`` and ``to`` are positions of masses, as `cage.corner.position`, or of points of rigid bodies, as
    `crate.hook`, of any models; one of them may be a place of its own, that of a `motion` too. Half of its energy
    belongs to each mass; all of it to the only one. The models are solved together. What the damping takes is counted
    as dissipated, less what moves the place gives. The velocity of a place is the central difference over 0.2 ms.

    For example `band: {spring: {from: fall.position, to: swing.bob.position, stiffness: 50 N/m}}`.
    """

    mutual: ClassVar[bool] = True

    said_by: ClassVar = dict.fromkeys(
        ("between", "ends", "bodies", "connect"), "write `from: NAME.position, to: NAME.position`, of two masses"
    )

    from_: Position = field("The position of a mass, or a place.")
    to: Position = field("The position of a mass, or a place.")
    stiffness: Stiffness = field("Force for a stretch.", "100 N/m", at_least=0)
    damping: Damping = field("Force for a speed of stretching.", "0 N*s/m", at_least=0)
    rest: FixedLength | None = field("Length without force; by default that at the start.", None, at_least=0)

    def problems(self) -> Iterator[Problem]:
        """Two ends without a mass."""
        if not self.targets():
            text = "a spring needs a mass at one of its ends, as `from: cage.corner.position`"
            yield Problem(text, help="what moves is of a model: `particles`, `mass_spring`, or `rigid`")

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
        """Inverse mass [1/kg] at an end, 0 for an end without a mass; None if the mass is not known."""
        if not isinstance(end.expr, Link) or end.expr.task not in on:
            return 0.0
        masses = on[end.expr.task]
        which = end.expr.output.rpartition(".")[0]
        return masses[which].inverse if which in masses else None

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add the spring. Raises ScriptError where an end is computed of masses but is none."""
        import numpy as np

        values = (self.from_, self.to)
        places = [self._place(value, assembly, everyone) for value in values]
        span = self.from_.span
        if places[0] is not None and places[0] == places[1]:
            raise ScriptError([Diagnostic("same-mass", "a spring leads from a mass to itself", self.to.span or span)])
        if places == [None, None]:
            raise ScriptError([Diagnostic("no-mass", "a spring needs a mass at one of its ends", span, OF_ELEMENTS)])
        length = float(np.linalg.norm(np.subtract(assembly.initial(self.to), assembly.initial(self.from_))))
        rest = assembly.floats([length if self.rest is None else self.rest])
        ends = [
            (-1, assembly.value(value), *(6 * (-1,))) if place is None else place.ints
            for place, value in zip(places, values, strict=True)
        ]
        law = (assembly.value(self.stiffness), assembly.value(self.damping), rest)
        speeds = tuple(self._speed(place, value, assembly) for place, value in zip(places, values, strict=True))
        if max(end[-1] for end in ends) >= 0:
            ints = (*ends[0], *ends[1], *law, *speeds)
            assembly.term(
                "force", "sceneql.words.forces.spring_on_bodies_kernels:spring", ints, lambda: _body_slopes(ends)
            )
        else:
            ints = (*ends[0][:3], *ends[1][:3], *law, *speeds)
            more = (*ints, ends[0][3], ends[1][3])
            assembly.term(
                "force",
                "sceneql.words.forces.spring_kernels:spring",
                ints,
                lambda: _slopes(ends, more),
                energy="sceneql.words.forces.spring_energy_kernels:energy",
                damped=number(self.damping) != 0.0,
            )
        assembly.remember(*ends[0], *ends[1], *law)

    def _place(self, value: Value, assembly: Assembly, everyone: Sequence[Bodies]) -> Place | None:
        """Mass, or point on a body, at an end; None for an end without either."""
        place = assembly.place(value.expr) if isinstance(value.expr, Link) else None
        return place if place is not None and place.bodies in everyone else None

    def _speed(self, mass: Place | None, value: Value, assembly: Assembly) -> int:
        """Offset of the velocity of an end that is a place, -1 for a mass.

        Raises ScriptError for a damped spring at a place whose velocity is not known.
        """
        if mass is not None:
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

        from sceneql.bodies.rigid.place_kernels import PLACE, WORK_AT, where

        ints = np.array(state.ints, dtype=np.int64)
        ends = [where(state.y, state.floats, ints, at) for at in (0, PLACE)]
        stiffness_at, _, rest_at = state.ints[2 * PLACE :]
        stretch = float(np.linalg.norm(np.subtract(*ends))) - state.floats[rest_at]
        works = [state.ints[at + WORK_AT] for at in (0, PLACE)]
        owned = works.count(bodies.work_at) / sum(work >= 0 for work in works)
        return float(0.5 * state.floats[stiffness_at] * stretch**2 * owned)


def _slopes(ends: Sequence[tuple[int, ...]], ints: Sequence[int]) -> Slopes:
    """Derivatives of a spring between masses or places (spring_slopes_kernels)."""
    import numpy as np

    from sceneql.system import Slopes

    kernels = "sceneql.words.forces.spring_slopes_kernels"
    i, j = np.divmod(np.arange(9), 3)
    masses = [end for end in ends if end[0] >= 0]
    pairs = [(one[1], other[which]) for one in masses for which in (0, 1) for other in masses]
    rows, columns = (np.concatenate(places) for places in zip(*((r + i, c + j) for r, c in pairs), strict=True))
    return Slopes(f"{kernels}:spring", rows, columns, ints, positive=f"{kernels}:positive")


def _body_slopes(ends: Sequence[tuple[int, ...]]) -> Slopes:
    """Derivatives of a spring to a point on a body (spring_on_bodies_slopes_kernels)."""
    from sceneql.bodies.rigid.place_slopes import force_places
    from sceneql.system import Slopes

    kernels = "sceneql.words.forces.spring_on_bodies_slopes_kernels"
    moving = [end for end in ends if end[0] >= 0]
    rows, columns = force_places([(one, other) for one in moving for other in moving])
    return Slopes(f"{kernels}:spring", rows, columns, positive=f"{kernels}:positive")
