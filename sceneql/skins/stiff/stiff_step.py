"""Preparation of an additive method in which stiff skins are implicit, too, where that is asked for or worth it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sceneql.flows.layout import LED
from sceneql.flows.schemes import additive
from sceneql.kinds.stable_step import stable_step
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.skins.elasticity import Elasticity, fastest
from sceneql.skins.skin_layout import (
    BEND_AT,
    COUNT,
    FLOW,
    HELD_AT,
    MODULUS_AT,
    POSITION_AT,
    PRETENSION_AT,
    STIFFNESS_AT,
)
from sceneql.skins.stiff.stiff_choice_kernels import BOUND, CHOICE, COST, LATER, WARM, WINDOW
from sceneql.skins.stiff.stiff_mixing_kernels import GRAM
from sceneql.skins.stiff.stiff_step_kernels import ROWS, STATE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.system import Flow, Prepared, Stepper

KERNELS = "sceneql.skins.stiff"
TENSION, PUSH = "sceneql.skins.closed_line_kernels:tension", "sceneql.skins.spline_kernels:push"
BENDING = "sceneql.skins.bend_line_kernels:bend"
LARGEST = 3000
"""Sides of all such skins: their matrix then takes 72 MB, or 288 MB where turns are unknowns, too."""
SOLVES, PAIR, FACTOR = 5.0, 0.3, 700.0
"""Explicit steps that an implicit one costs: by its solves of the fluid, by pairs of sides over cells, more by as many
sides as have its factor cost as much (tests/bench/bench_skins.py stiff)."""


class Lines(NamedTuple):
    """The flat skins in a flow."""

    skins: Sequence[Any]
    """The integers of their tensions."""
    ties: Sequence[Any]
    """Those of what ties each to the flow."""
    bends: Sequence[int]
    """Where the stiffness of each against bending is in the floats; -1 where it has none."""
    why: str
    """Why they cannot be implicit; empty where they can."""

    @property
    def sides(self) -> int:
        """How many sides all of them have."""
        return sum(int(ints[COUNT]) for ints in self.skins)

    def laws(self, flow: Flow, floats: Floats) -> list[Elasticity]:
        """Of each its elastic constants; the modulus of Skalak's law is that of a line, with the resistance to area."""
        found, depth = [], flow.spacing[2]
        for ints, bend in zip(self.skins, self.bends, strict=True):
            at = [ints[PRETENSION_AT], ints[STIFFNESS_AT], ints[MODULUS_AT], ints[MODULUS_AT] + 1]
            found.append(Elasticity(*(float(floats[one]) / depth for one in at)))
            if bend >= 0:
                found[-1] = replace(found[-1], bend=float(floats[bend]) / depth)
        return found

    def cost(self, flow: Flow, floats: Floats) -> float:
        """Explicit steps that a step with implicit skins costs, by counts of operations."""
        cells, sides = float(np.prod(flow.cells.shape)), self.sides
        across = any(one.tension > 0.0 or one.bend > 0.0 for one in self.laws(flow, floats))
        unknowns = 2 * sides if across else sides
        return SOLVES + PAIR * sides**2 / cells * (1.0 + (unknowns / sides) ** 3 * sides / FACTOR)

    def bound(self, flow: Flow, floats: Floats) -> float:
        """The longest step [s] that the explicit method bears by their tensions; infinite without skins."""
        cell, axes = min(flow.spacing[:2]), 2
        largest = max((fastest(one, cell) for one in self.laws(flow, floats)), default=0.0)
        if largest == 0.0:
            return float("inf")
        turn = float((largest / (flow.density * cell**3)) ** 0.5)
        decay = flow.viscosity / flow.density * axes / cell**2
        size = max(turn, decay)
        return stable_step(lambda step: additive.growth(decay / size, turn / size, step)) / size


def lines_of(stiff: Sequence[tuple[str, Any]], flow: Flow | None) -> Lines | None:
    """The flat skins among terms (System.stiff) of an island; None where no skin is in a flow of one fluid.

    A skin in a deep flow has no such term, and is explicit.
    """
    ties = {int(ints[POSITION_AT]): ints for kernel, ints in stiff if kernel == PUSH}
    skins = [ints for kernel, ints in stiff if kernel == TENSION and int(ints[POSITION_AT]) in ties]
    if not ties or flow is None:
        return None
    sides, why = sum(int(ints[COUNT]) for ints in skins), ""
    if not skins:
        why = "no flat skin, which alone can be implicit"
    elif flow.ints[LED] > 0:
        why = "implicit skins go with no solids that move"
    elif sides > LARGEST:
        why = f"implicit skins have {sides} sides, more than {LARGEST}"
    bent = {int(ints[POSITION_AT]): int(ints[BEND_AT]) for kernel, ints in stiff if kernel == BENDING}
    at = [int(ints[POSITION_AT]) for ints in skins]
    return Lines(skins, [ties[one] for one in at], [bent.get(one, -1) for one in at], why)


def implicit(made: Stepper) -> Stepper:
    """``made``, that of the additive pair, with skins implicit."""
    return _stepped(made, "stiff_step_kernels", "prepare")


def chosen(made: Stepper) -> Stepper:
    """``made``, that of the additive pair by a tolerance, with skins implicit where that is worth it."""
    return _stepped(made, "stiff_choice_kernels", "prepare_choice")


def _stepped(made: Stepper, kernels: str, prepare: str) -> Stepper:
    return replace(
        made,
        method=replace(made.method, step=f"{KERNELS}.{kernels}:step"),
        needs=replace(made.needs, prepare=f"{KERNELS}.stiff_step:{prepare}"),
    )


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Settings, numbers and scratch of stiff_step_kernels.step. Raises ScriptError where no skin can be implicit."""
    flat = additive.prepare(system, stepper)
    _, _, part, spans = system.ranges[0]
    found = lines_of(system.stiff, system.fields.flow)
    why = f"'{part}' has no skin" if found is None else found.why
    if found is None or why:
        why = f"'{part}' has {why}" if why.startswith("no ") else why
        raise ScriptError([Diagnostic("invalid", why, spans[0], "write `skins: explicit`")])
    lines, first, sides = [len(found.skins), found.sides], 0, found.sides
    for ints, bend, tie in zip(found.skins, found.bends, found.ties, strict=True):
        lines += [*(int(one) for one in ints[: HELD_AT + 1]), bend, *(int(one) for one in tie[: FLOW + 1]), first]
        first += int(ints[COUNT])
    numbers = np.array([*flat.numbers, *lines, len(flat.settings), len(flat.numbers)], dtype=np.int64)
    work = flat.work + STATE + (ROWS + 4 * sides) * sides + GRAM + 2 * len(system.y)
    text = f"{flat.text}; the tensions of {sides} sides of skins implicit, by Newton's method"
    return replace(flat, numbers=numbers, work=work, text=text)


def prepare_choice(system: System, stepper: Stepper) -> Prepared:
    """Those of stiff_choice_kernels.step."""
    made, flow = prepare(system, stepper), system.fields.flow
    found = lines_of(system.stiff, flow)
    assert flow is not None
    assert found is not None
    choice = np.zeros(CHOICE)
    choice[BOUND], choice[COST] = found.bound(flow, system.floats), found.cost(flow, system.floats)
    choice[LATER] = 0.5 * (WARM + WINDOW) * choice[COST]
    return replace(made, settings=np.append(made.settings, choice))


def remark(found: Lines, flow: Flow, floats: Floats, step: float | None) -> str:
    """How skins of an island are marched by default, and why, for `explain`; ``step``: one of fixed length [s]."""
    if found.why:
        return f"with skins explicit: there is {found.why}" if found.why.startswith("no ") else found.why
    sides, bound = f"the tensions of {found.sides} sides of skins", found.bound(flow, floats)
    if step is None:
        cost = f"{found.cost(flow, floats):.2g} times as long, which one with implicit tensions costs"
        return (
            f"with {sides} explicit up to their bound of {bound:.3g} s, and implicit where the flow's steps are {cost}"
        )
    way = "implicit, as its step is beyond" if step > bound else "explicit, as its step is within"
    return f"with {sides} {way} their bound of {bound:.3g} s"
