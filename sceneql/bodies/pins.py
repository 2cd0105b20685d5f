"""Pins: masses of a net that are held, moved in a prescribed way, and released."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from sceneql.bodies.time_shift import APART, later
from sceneql.island.breakpoint_table import after
from sceneql.kinds import FixedTime, Formula, Position, Record, Symbols, Value, field
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Expr, Symbol

if TYPE_CHECKING:
    from sceneql.bodies.nets import Net
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies


class Pin(Record):
    """How masses are held, and which: those of its name, or all where a formula is true at the start."""

    where: Annotated[Formula, Symbols(("x", "y", "z"))] | None = field(
        "A formula of the place [m] that holds for these masses at the start, `y > 1.9`; their name is free then.",
        None,
    )
    shift: Position = field("How far they have been moved from where they start.", "0 0 0 m")
    until: FixedTime | None = field(
        "They are let go at the end of the solver's step that reaches this time; by default never.", None, at_least=0
    )


def start_velocity(pin: Pin, assembly: Assembly) -> Floats:
    """Velocity (3,) [m/s] of a pin's masses at the start."""
    import numpy as np

    ends = [np.asarray(assembly.initial(Value(_at(pin.shift, by, assembly)))) for by in (-APART, APART)]
    velocity: Floats = (ends[1] - ends[0]) / (2 * APART)
    return velocity


def pinned(name: str, net: Net, pin: Pin | None = None) -> Any:
    """Indices (k,) of a pin's masses. Raises ScriptError where its formula is true for none."""
    import numpy as np

    if pin is not None and pin.where is not None:
        known = {Symbol(axis): net.points[:, k] for k, axis in enumerate("xyz")}
        held = np.broadcast_to(evaluate(pin.where.expr, known, arrays=True), len(net.points))
        if not held.any():
            message = f"pin '{name}': no mass starts where this is true"
            raise ScriptError([Diagnostic("no-mass", message, pin.where.span)])
        return np.flatnonzero(held)
    return np.arange(len(net.points))[net.places[name] if name in net.places else [int(name)]].ravel()


def guide(pins: Mapping[str, Pin], net: Net, assembly: Assembly, bodies: Bodies) -> None:
    """Add the prescribed motion of pins to an island; the work done by them is subtracted from the dissipated energy.

    Velocities and accelerations are central differences of the shift. Raises ScriptError for a shift that is no
    function of time.
    """
    import numpy as np

    from sceneql.system import Slopes

    folder = "sceneql.bodies.pins_kernels"
    for name, pin in pins.items():
        masses = pinned(name, net, pin)
        if pin.shift.constant and pin.until is None and not np.any(assembly.initial(pin.shift)):
            continue
        starts = assembly.floats(net.points[masses])
        shifts = [assembly.value(Value(_at(pin.shift, by, assembly), pin.shift.span)) for by in (-APART, 0.0, APART)]
        places = (bodies.position_at, bodies.velocity_at, bodies.work_at, bodies.mass_at, bodies.inverse_at)
        if pin.until is not None:
            assembly.stop_at(pin.until - APART)  # dense output uses the rates at both ends of a step: a short last one
            assembly.stop_at(after(pin.until))
        until = assembly.floats([float("inf") if pin.until is None else pin.until])
        ints = (*places, *shifts, assembly.floats([APART]), starts, until, len(masses), *masses.tolist())
        alone = Slopes("", (), ())
        assembly.term("internal", f"{folder}:toil", ints, alone, energy="")
        assembly.term("constrain", f"{folder}:lead", ints, alone, energy="")
        assembly.after_step(f"{folder}:put", ints)


def _at(shift: Value, by: float, assembly: Assembly) -> Expr:
    """The shift at time t + ``by`` [s]. Raises ScriptError where it is no function of time."""
    try:
        return later(shift.expr, by, assembly.formula)
    except ValueError as error:
        message = f"a pin is moved by a function of time: {error}"
        raise ScriptError([Diagnostic("unsupported-link", message, shift.span)]) from None
