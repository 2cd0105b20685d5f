"""Stops, motors and dry friction of ties in exact contacts of rigid bodies: their integers and floats."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sceneql.bodies.rigid.ties.tie_system import integers
from sceneql.bodies.rigid.ties.tied_step import drive_integers, moves
from sceneql.bodies.time_shift import exact_rate, rate_of_change
from sceneql.island.breakpoints import Breakpoints
from sceneql.kinds import Value
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import Place

if TYPE_CHECKING:
    from sceneql.quantities.expression import Expr
    from sceneql.system import Assembly, Drive, Mover, Tied


def work_of(mover: Mover) -> int:
    """Offset in y of the energy that is taken from the bodies of a mover; -1: none has mass."""
    return mover.bodies.work_at if isinstance(mover, Place) else -1


def drives_of(
    assembly: Assembly, movers: list[tuple[int, ...]], works: list[int]
) -> tuple[list[list[float]], list[list[int]]]:
    """Floats (stop_kernels) and integers (motion_kernels) of the ties with stops, a motor or friction.

    Adds the tied bodies to ``movers`` and ``works``, and marks the assembly as driven, so that no velocity step moves
    these ties. Raises ScriptError for a motor whose target has no known rate, or jumps.
    """
    from sceneql.bodies.rigid.drive_kernels import ROW_AT
    from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_J, SCRATCH
    from sceneql.contacts.rigid_exact.stop_kernels import DRIVEN, EFFORT_AT, FIRST_MOVER, GIVEN_AT, SIZE
    from sceneql.contacts.rigid_exact.stop_kernels import ROW_AT as OWN_ROW_AT

    found: list[list[float]] = []
    ints: list[list[int]] = []
    numbers = assembly.numbers()
    driven = [
        (tie, tie.drive) for tie in assembly.ties if tie.drive and any(moves(one, assembly) for one in tie.movers)
    ]
    rates = [_rates(tie, drive, assembly) for tie, drive in driven]  # raises before anything is added
    for (tie, drive), rate in zip(driven, rates, strict=True):
        own = [0.0] * DRIVEN
        for side, mover in enumerate(tie.movers):
            one = integers(mover)
            if one not in movers:
                movers.append(one)
                works.append(work_of(mover))
            own[FIRST_MOVER + side] = movers.index(one)
        low, high = numbers[drive.limits_at : drive.limits_at + 2] if drive.limits_at >= 0 else (0.0, 0.0)
        own[SIZE] = float(high - low) if 0.0 < high - low < math.inf else 1.0
        own[OWN_ROW_AT] = drive.along[ROW_AT + SCRATCH] + AT_J
        own[EFFORT_AT], own[GIVEN_AT] = drive.effort_at, assembly.state([0.0])
        assembly.write(drive.effort_at + 3, [1.0])
        found.append(own)
        ints.append([*drive_integers(drive), *rate])
    assembly.driven = True
    return found, ints


def _rates(tie: Tied, drive: Drive, assembly: Assembly) -> tuple[int, int]:
    """Offsets of the first and second time derivatives of a motor's target; -1 if it is constant.

    Raises ScriptError for one whose speed jumps: no gap tells the instant at which the motor has to let go.
    """
    target = drive.target
    if target is None or target.constant:
        return -1, -1

    def rate(expr: Expr) -> Expr:
        return exact_rate(expr, assembly.formula) or rate_of_change(expr, assembly.formula)

    try:
        first = rate(target.expr)
        leap = Breakpoints(assembly.formula, assembly.end).leap(target.expr, bends=drive.follows != "speed")
        if leap is not None:
            raise ValueError(f"its speed jumps at {leap:.6g} s")
        return assembly.value(Value(first, target.span)), assembly.value(Value(rate(first), target.span))
    except ValueError as error:
        message = f"it cannot be told how what the motor of '{tie.name}' follows changes: {error}"
        raise ScriptError([Diagnostic("no-velocity", message, target.span, "`mode: local` takes it")]) from None
