"""Preparation of an additive method in which stiff skins are implicit, too."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows.layout import LED
from sceneql.flows.schemes import additive
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.skins.skin_layout import COUNT, FLOW, HELD_AT, POSITION_AT
from sceneql.skins.stiff.stiff_step_kernels import ROWS, STATE

if TYPE_CHECKING:
    from sceneql.island.system import System
    from sceneql.system import Prepared, Stepper

TENSION, PUSH = "sceneql.skins.closed_line_kernels:tension", "sceneql.skins.spline_kernels:push"
LARGEST = 3000
"""Sides of all such skins: their matrix then takes 72 MB."""


def stepper(tolerance: float, step: float | None, largest: float | None) -> Stepper:
    """That of ark3, with skins implicit."""
    made = additive.stepper(tolerance, step, largest)
    return replace(
        made,
        method=replace(made.method, step="sceneql.skins.stiff.stiff_step_kernels:step"),
        needs=replace(made.needs, prepare="sceneql.skins.stiff.stiff_step:prepare"),
    )


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Settings, numbers and scratch of stiff_step_kernels.step. Raises ScriptError where no skin can be implicit."""
    flat = additive.prepare(system, stepper)
    flow, (_, _, part, spans) = system.fields.flow, system.ranges[0]
    ties = {int(ints[POSITION_AT]): ints for kernel, ints in system.stiff if kernel == PUSH}
    skins = [ints for kernel, ints in system.stiff if kernel == TENSION and int(ints[POSITION_AT]) in ties]
    sides = sum(int(ints[COUNT]) for ints in skins)
    why = ""
    if not skins:
        why = f"'{part}' has no flat skin of springs, which alone can be implicit"
    elif flow is not None and flow.ints[LED] > 0:
        why = "implicit skins go with no solids that move"
    elif sides > LARGEST:
        why = f"implicit skins have {sides} sides, more than {LARGEST}"
    if why:
        raise ScriptError([Diagnostic("invalid", why, spans[0], "write `skins: explicit`")])
    lines, first = [len(skins), sides], 0
    for ints in skins:
        tie = ties[int(ints[POSITION_AT])]
        lines += [*(int(one) for one in ints[: HELD_AT + 1]), *(int(one) for one in tie[: FLOW + 1]), first]
        first += int(ints[COUNT])
    numbers = np.array([*flat.numbers, *lines, len(flat.numbers)], dtype=np.int64)
    work = flat.work + STATE + (ROWS + sides) * sides + 2 * len(system.y)
    text = f"{flat.text}; the tensions of {sides} sides of skins implicit, by Newton's method"
    return replace(flat, numbers=numbers, work=work, text=text)
