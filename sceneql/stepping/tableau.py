"""Explicit Runge-Kutta methods as data: tableau, order by the order conditions, growth factor."""

from __future__ import annotations

from cmath import sqrt
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations_with_replacement
from math import inf, prod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Method, Stepper

KERNELS = "sceneql.stepping.runge_kutta_kernels"
HIGHEST_ORDER = 8
TOLERANCE = 1e-10
"""Tolerance of an order condition: coefficients may be rounded decimals."""

Tree = tuple["Tree", ...]
"""A rooted tree, as the tuple of its branches."""


@dataclass(frozen=True)
class Tableau:
    """Coefficients of an explicit method: row i of ``a`` has the i entries below the diagonal (Butcher 1964)."""

    a: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    b_hat: tuple[float, ...] | None = None
    """Weights of the embedded method whose difference is the error."""
    dense: str | None = None
    """Kernel of the method's own dense output; None: Hermite interpolation."""

    @property
    def stages(self) -> int:
        """Number of stages."""
        return len(self.b)

    @cached_property
    def c(self) -> tuple[float, ...]:
        """Nodes of the stages, as fractions of the step: the row sums."""
        return tuple(sum(row) for row in self.a)

    @cached_property
    def order(self) -> int:
        """The order up to which all order conditions hold (Hairer, Norsett & Wanner 1993, theorem II.2.13)."""
        for order in range(1, HIGHEST_ORDER + 1):
            for tree in trees(order):
                total = sum(b * s for b, s in zip(self.b, self._elementary(tree), strict=True))
                if abs(total - 1.0 / density(tree)) > TOLERANCE:
                    return order - 1
        return HIGHEST_ORDER

    @property
    def first_same_as_last(self) -> bool:
        """Whether the last stage is the rate at the step's end."""
        return len(self.a[-1]) > 0 and (*self.a[-1], 0.0) == self.b

    def fixed(self, step: float) -> Stepper:
        """Stepper of fixed length [s]."""
        from sceneql.system import Control, Stepper

        return Stepper(self._method(None, 0.0, 0.0), Control(first_step=step))

    def adaptive(
        self,
        tolerance: float,
        absolute: float,
        *,
        first_step: float = 0.0,
        largest_step: float = inf,
        by_scale: bool = False,
    ) -> Stepper:
        """Adaptive stepper by the error of the embedded method. Raises ValueError where there is none."""
        if self.b_hat is None:
            raise ValueError("a method without an embedded one has no error estimate")
        from sceneql.system import Control, Needs, Stepper

        control = Control(
            first_step=first_step,
            adaptive=True,
            tolerance=tolerance,
            absolute=absolute,
            by_scale=by_scale,
            largest_step=largest_step,
        )
        needs = Needs(prepare="sceneql.stepping.error_scales:prepare") if by_scale else Needs()
        return Stepper(self._method(self.b_hat, tolerance, absolute), control, needs)

    def growth(self, jacobian: Floats, step: float) -> float:
        """max |R(step * lambda)| over the eigenvalues of a (n, n) Jacobian, R(z) = 1 + sum of z^k b A^(k-1) 1."""
        import numpy as np

        z = step * np.linalg.eigvals(jacobian)
        return float(np.abs(np.polyval(self.stability_function[::-1], z)).max(initial=0.0))

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float:
        """max |R(step * lambda)| over the roots of lambda^2 + (decay - i turn) lambda + frequency^2."""
        half = 0.5 * complex(decay, -turn)
        root = sqrt(half * half - frequency * frequency)
        return max(abs(self._amplification(step * (sign * root - half))) for sign in (1, -1))

    @cached_property
    def stability_function(self) -> tuple[float, ...]:
        """Coefficients of the stability function R(z), beginning with z^0."""
        powers = [1.0]
        stage = (1.0,) * self.stages
        for _ in range(self.stages):
            powers.append(sum(b * s for b, s in zip(self.b, stage, strict=True)))
            stage = self._inner(stage)
        return tuple(powers)

    def _amplification(self, z: complex) -> complex:
        total = 0j
        for power in reversed(self.stability_function):
            total = total * z + power
        return total

    def _method(self, embedded: tuple[float, ...] | None, relative: float, absolute: float) -> Method:
        from sceneql.system import Method

        differences = [b - other for b, other in zip(self.b, embedded or self.b, strict=True)]
        lower = [entry for row in self.a for entry in row]
        return Method(
            step=f"{KERNELS}:step",
            order=self.order,
            dense=self.dense,
            settings=(relative, absolute, *self.c, *self.b, *differences, *lower),
            numbers=(self.stages, int(embedded is not None), 0),
            work=self.stages,
            last_stage=self.stages - 1 if self.first_same_as_last else -1,
        )

    def _inner(self, stage: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(sum(a * s for a, s in zip(row, stage, strict=False)) for row in self.a)

    def _elementary(self, tree: Tree) -> tuple[float, ...]:
        branches = [self._inner(self._elementary(branch)) for branch in tree]
        return tuple(prod(branch[i] for branch in branches) for i in range(self.stages))


def size(tree: Tree) -> int:
    """Number of nodes of a tree."""
    return 1 + sum(size(branch) for branch in tree)


def density(tree: Tree) -> int:
    """Butcher's gamma: the product of the sizes of all its subtrees."""
    return size(tree) * prod(density(branch) for branch in tree)


@cache
def trees(order: int) -> tuple[Tree, ...]:
    """All rooted trees with ``order`` nodes: 1, 1, 2, 4, 9, 20, 48, 115 of them."""
    return tuple(_forests(order - 1, order - 1))


def _forests(nodes: int, largest: int) -> Iterator[Tree]:
    """All multisets of trees with ``nodes`` nodes in total, no tree larger than ``largest``."""
    if nodes == 0:
        yield ()
        return
    for biggest in range(min(nodes, largest), 0, -1):
        for count in range(1, nodes // biggest + 1):
            for rest in _forests(nodes - count * biggest, biggest - 1):
                for chosen in combinations_with_replacement(trees(biggest), count):
                    yield (*chosen, *rest)


EULER = Tableau(((),), (1.0,))
MIDPOINT = Tableau(((), (0.5,)), (0.0, 1.0))
CLASSIC = Tableau(((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)), (1 / 6, 1 / 3, 1 / 3, 1 / 6))
DORMAND_PRINCE = Tableau(
    (
        (),
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
        (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
    ),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 0.0),
    (5179 / 57600, 0.0, 7571 / 16695, 393 / 640, -92097 / 339200, 187 / 2100, 1 / 40),
    dense="sceneql.stepping.dopri5_dense_kernels:dopri5_dense",
)
