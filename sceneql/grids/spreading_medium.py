"""Base of the models of fields that diffuse and are advected by a drift."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated

from sceneql.grids.drift import Drift
from sceneql.grids.medium import ANY, SHORTEST, Medium, largest_in, number_in, spacing_of
from sceneql.kinds import Formula, Problem, Symbols, field
from sceneql.kinds.stable_step import Oscillation, StaticScene
from sceneql.quantities import dimension as dim

COEFFICIENT = Annotated[Formula, Symbols(ANY, dim.AREA / dim.TIME)]


class SpreadingMedium(Medium):
    """A medium whose fields have diffusion coefficients."""

    drift: Drift | None = field("A flow that carries what spreads.", None)

    def coefficients(self) -> Iterable[tuple[Formula | None, tuple[str, ...]]]:
        """The diffusion coefficient of each field, and its path in the script."""
        raise NotImplementedError

    def problems(self) -> Iterable[Problem]:
        """Problems of any medium; negative coefficients; drifts with a wrong number of components."""
        yield from super().problems()
        for coefficient, path in self.coefficients():
            d = number_in(coefficient)
            if d is not None and d < 0.0:
                yield Problem(f"the coefficient must be at least 0, and is {d:g}", path, code="out-of-range")
        if self.drift is not None and self.size is not None and self.cell >= SHORTEST:
            yield from self._misled(self.drift, len(self.size))

    def _misled(self, drift: Drift, sides: int) -> Iterable[Problem]:
        if drift.by is not None:
            return
        if drift.velocity is not None and drift.velocity.expr.type.shape != (sides,):
            yield Problem(f"the velocity of a drift needs {sides} components, one for each side", ("drift",))
        if drift.velocity is None and sides == 3:
            yield Problem("a deep drift has a velocity, not a stream function", ("drift",))

    def spreading(self, coefficient: Formula | None, scene: StaticScene) -> Oscillation | None:
        """The rates that limit explicit steps of a field: decay of the checkerboard mode, and the drift.

        The former is 4 D sum of 1/spacing^2 (von Neumann's bound), with the largest D at the start if D varies in a
        box. None where D varies with the field or with other parts, or varies in an object's domain.
        """
        d = 0.0 if coefficient is None else number_in(coefficient)
        if d is None and self.size is not None:
            d = largest_in(coefficient, self.corner or (0.0,) * len(self.size), self.size)
        if d is None:
            return None
        spacing = spacing_of(self, scene)
        rate = 4.0 * d * sum(1.0 / side**2 for side in spacing)
        carried = 0.0
        if self.drift is not None and coefficient is not None and self.size is not None:
            carried = self.drift.fastest(self.corner or (0.0,) * len(spacing), self.size, spacing)
        ways = " and ".join(way for way, one in (("spread", rate), ("drift", carried)) if one > 0.0)
        if not ways:
            return None
        return Oscillation(0.0, rate + carried, f"the {ways} over cells of {self.cell:g} m", ("cell",))
