"""runge_kutta: an explicit Runge-Kutta method with the script's own tableau."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, FixedTime, Problem, Solver, field
from sceneql.stepping.tableau import Tableau

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper

ROUNDING = 1e-9


class RungeKutta(Solver):
    """An explicit Runge-Kutta method by its tableau: k_i = f(t + c_i h, y + h sum_j a_ij k_j), y1 = y + h sum b_i k_i.

    With ``b_hat`` and a ``tolerance`` the steps follow the difference of the two methods, else they are ``step`` long.
    Its order is found from the order conditions. Source: Kutta (1901); Butcher (1964).
    """

    a: tuple[tuple[FixedScalar, ...], ...] = field("Rows of the matrix, the first (empty or zero) included.")
    b: tuple[FixedScalar, ...] = field("Weights of the stages; their sum is 1.")
    c: tuple[FixedScalar, ...] | None = field("Places of the stages, which must be the row sums of `a`.", None)
    b_hat: tuple[FixedScalar, ...] | None = field("Weights of an embedded method of lower order.", None)
    step: FixedTime = field("Length of a step, or with a tolerance of the first.", "1 ms", above=0)
    tolerance: FixedScalar | None = field("Relative error of a step; needs b_hat.", None, at_least=1e-14, below=1)

    def problems(self) -> Iterator[Problem]:
        """A tableau that is of no explicit method, or of none that converges."""
        stages = len(self.b)
        if stages == 0 or len(self.a) != stages:
            text = f"`a` has {len(self.a)} rows and `b` {stages} weights: one of each for every stage"
            yield Problem(text, ("b",) if stages == 0 else ("a",), at_key=True)
            return
        for i, row in enumerate(self.a):
            for j, entry in enumerate(row):
                if j >= i and entry:
                    text = f"row {i + 1} of `a` reaches the diagonal: only explicit methods can be written here"
                    yield Problem(text, ("a", i, j))
                    break
            if len(row) < i:
                yield Problem(f"row {i + 1} of `a` has {len(row)} entries: it needs {i}", ("a", i))
        if abs(sum(self.b) - 1.0) > ROUNDING:
            text = f"the weights `b` sum to {sum(self.b):.12g}, not to 1: the method would not converge"
            yield Problem(text, ("b",))
        if self.c is not None and len(self.c) != stages:
            yield Problem(f"`c` has {len(self.c)} places: it needs {stages}, the row sums of `a`", ("c",))
        else:
            for i, (place, row) in enumerate(zip(self.c or (), self.a, strict=False)):
                if abs(place - sum(row)) > ROUNDING:
                    text = f"`c` must be the row sums of `a`: that of row {i + 1} is {sum(row):.12g}"
                    yield Problem(text, ("c", i))
        if self.b_hat is not None and len(self.b_hat) != stages:
            yield Problem(f"`b_hat` needs {stages} weights", ("b_hat",))
        if self.tolerance is not None and (self.b_hat is None or self.b_hat == self.b):
            text = "a tolerance needs the weights `b_hat` of an embedded method that differs from `b`"
            yield Problem(text, ("tolerance" if self.b_hat is None else "b_hat",))

    @cached_property
    def tableau(self) -> Tableau:
        """The method."""
        lower = tuple(row[:i] for i, row in enumerate(self.a))
        return Tableau(lower, self.b, self.b_hat)

    def explicit_by_tolerance(self) -> bool:
        """With a tolerance it is."""
        return self.tolerance is not None

    def stepper(self) -> Stepper:
        """Fixed steps, or by the embedded error."""
        if self.tolerance is None:
            return self.tableau.fixed(self.step)
        return self.tableau.adaptive(self.tolerance, self.tolerance, first_step=self.step)

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)| with the stability function of the tableau."""
        return self.tableau.growth(jacobian, step)

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """That of the tableau, for fixed steps."""
        return None if self.tolerance is not None else self.tableau.oscillation(frequency, decay, step, turn)
