"""Small islands for the solver tests, of the kernels in solver_kernels.py."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sceneql.island.island import IslandAssembly
from sceneql.island.system import System
from sceneql.kinds import Object, Ref, Solver
from sceneql.march.march import March
from sceneql.quantities.expression import Expr, Link
from sceneql.quantities.span import Source, Span
from sceneql.system import IslandFacts, Stepper

SOURCE = Source("scene.yaml", "springs:\n  weak: 1\n  tether: 2\n")
TETHER = Span(SOURCE, 20, 26)


@dataclass(frozen=True)
class Scene:
    """Links to formulas by their text, and nothing else."""

    formulas: dict[str, Expr]
    end: float = 100.0

    def object(self, ref: Ref) -> Object:
        raise KeyError(ref.name)

    def formula(self, link: Link) -> Expr | None:
        return self.formulas.get(f"{link.task}.{link.output}")


def assembly(formulas: dict[str, Expr] | None = None) -> IslandAssembly:
    return IslandAssembly(Scene(formulas or {}))


def simple(kernel: str, start: Sequence[float], numbers: Sequence[float] = (), paired: bool = False) -> System:
    """One term on one part; the second half of the state are the velocities of the first if ``paired``."""
    island = assembly()
    with island.word("model", TETHER):
        island.state(start)
    if paired:
        island.pair(0, len(start) // 2, len(start) // 2)
    island.term("internal", f"solver_kernels:{kernel}", (island.floats(numbers),))
    return island.finish(jacobian=True)


def springs(squares: Sequence[float], dampings: Sequence[float]) -> System:
    """Unit masses on springs, x'' = -square x - damping x', from x = v = 1; the last is the part 'tether'."""
    island = assembly()
    n = len(squares)
    with island.word("springs", None):
        lines = [None] * (n - 1) + [TETHER]
        position, velocity = island.state(np.ones(n), lines), island.state(np.ones(n), lines)
    island.pair(position, velocity, n)
    at = island.floats(np.column_stack([squares, dampings]))
    island.term("internal", "solver_kernels:oscillators", (n, position, velocity, at))
    return island.finish(jacobian=True)


@dataclass(frozen=True)
class Balls:
    """Balls over a floor, with where their contact keeps its numbers."""

    system: System
    rest_at: int
    hit_at: int


def balls(heights: Sequence[float], restitution: float, g: float = 9.81, mode: str = "exact") -> Balls:
    island = assembly()
    start = np.zeros(2 * len(heights))
    start[::2] = heights
    with island.word("balls", None):
        island.state(start)
    ints = [
        island.floats([g]),
        island.floats([restitution]),
        *(island.floats(np.zeros(len(heights))) for _ in range(3)),
    ]
    island.term("internal", "solver_kernels:heights", ints)
    island.term("constrain", "solver_kernels:held", ints)
    if mode == "exact":
        kernels = ("solver_kernels:floor_gap", "solver_kernels:floor_impact")
        island.contact("exact", kernels, ints, len(heights))
    else:
        island.contact("local", ("solver_kernels:floor_back_off",), ints, len(heights))
    return Balls(island.finish(jacobian=True), ints[3], ints[4])


def fixed(stepper: Stepper, step: float) -> Stepper:
    """The same method with steps of one length."""
    return replace(stepper, control=replace(stepper.control, adaptive=False, first_step=step))


def march_by(kind: Solver, system: System, end: float) -> March:
    """The march of a system by what a solver word chooses for it."""
    methods = kind.choose(IslandFacts(len(system.y), local_contacts=bool(system.structure.local)))
    return March(system, methods.first, end, stiff=methods.stiff, otherwise=methods.otherwise)


def final(system: System, stepper: Stepper, end: float) -> np.ndarray:
    return March(system, stepper, end).advance(end)[0]
