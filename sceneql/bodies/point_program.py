"""Forces given by formulas of a mass's position, velocity, mass and charge, printed as compiled kernels.

The kernels are terms. Integers of a force on all masses: constants_at, position_at, velocity_at, count, mass_at,
inverse_at, work_at, charge_at, charge_step (0: one charge for all), then the offset of each value read from other
parts. Integers of a force or torque at a place on a body: constants_at, mass_at, Place.ints, then such offsets.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from sceneql.compiled.printer import Constants, Printer, printable, write_term
from sceneql.kinds import Formula, Value
from sceneql.quantities.derivative import components, differentiate
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import TIME_SYMBOL, Call, Expr, Link, Number, Symbol, walk

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, ModelState, Place

PLACE = ("x", "y", "z")
MOTION = (*PLACE, "vx", "vy", "vz")
CHARGE = Symbol("q")
HEAD = 9
AT, PLACE_INTS = 2, 8
"""Index of the first integer of a place on a body, and the number of its integers."""
ZERO = Number(0.0)
NAMES = {name: f"own_{name}" for name in (*MOTION, "m", "q")} | {TIME_SYMBOL: "t"}
"""Names in the kernel of a mass's own quantities, prefixed because `y` is the state."""


def problem(formula: Formula, count: int) -> str | None:
    """The message on a formula that is not ``count`` scalars which a kernel can compute; None for a valid one."""
    try:
        parts = components(formula.expr)
    except TypeError as error:
        return f"a formula cannot be computed: {error}"
    if len(parts) != count:
        return f"{count} {'formula is' if count == 1 else 'formulas are'} needed here, not {len(parts)}"
    return None if all(map(printable, parts)) else "a formula uses an operation that a force cannot compute"


def remedy(formula: Formula, count: int) -> str | None:
    """The help where one formula stands for one along each axis."""
    if formula.expr.type.shape or count != len(PLACE) or formula.span is None:
        return None
    text = formula.span.text.strip("\"'")
    return f"it has one for each of x, y and z: write `[{text}, 0, 0]`"


def downhill(potential: Formula) -> tuple[Expr, ...]:
    """The three scalar components of minus the gradient of a potential."""
    (phi,) = components(potential.expr)
    return tuple(Call("neg", (differentiate(phi, Symbol(name)),)) for name in PLACE)


def scaled(rows: Sequence[Expr], factor: Expr) -> tuple[Expr, ...]:
    """Each expression times a factor."""
    return tuple(Call("mul", (factor, row)) for row in rows)


def add_force(
    assembly: Assembly, bodies: Bodies, rows: Sequence[Expr], charge: tuple[int, int] = (0, 0), *, counted: bool
) -> None:
    """Add a force [N] on every mass, with components ``rows`` (3); ``counted``: its power is counted as work.

    ``charge``: offset of the charges, and stride, 0 for one charge for all.
    """
    from sceneql.system import Slopes

    for row in rows:
        assembly.stop_at_breakpoints(row)
    constants = Constants()
    printer = Printer(NAMES, {}, constants)
    forces = [printer.name(row) for row in [constants.lift(row) for row in rows]]
    outputs = [f"out[velocity_at + 3 * k + {c}] += {force}" for c, force in enumerate(forces)]
    if counted:
        power = " + ".join(f"{force} * {NAMES[v]}" for force, v in zip(forces, MOTION[3:], strict=True))
        outputs.append(f"out[ints[6]] -= {power}")
    head = (bodies.position_at, bodies.velocity_at, bodies.count, bodies.mass_at, bodies.inverse_at, bodies.work_at)

    def store(constants: Constants) -> tuple[int, ...]:
        inputs = [assembly.value(Value(expr)) for expr in constants.inputs]
        return (assembly.floats(constants.values), *head, *charge, *inputs)

    # The derivatives' constants are stored now, since no floats can be added when a solver asks for the Jacobian.
    entries, kernel, more = _slopes(rows)
    ints = store(more)

    def slopes() -> Slopes:
        import numpy as np

        first = 3 * np.arange(bodies.count)[:, None]
        columns = np.array(
            [(bodies.position_at, bodies.velocity_at)[n // 3] + n % 3 for _, n in entries], dtype=np.int64
        )
        rows = bodies.velocity_at + np.array([c for c, _ in entries], dtype=np.int64)
        return Slopes(kernel(), (first + rows).ravel(), (first + columns).ravel(), ints)

    name = _kernel("force", printer, outputs)
    assembly.term("force", name, store(constants), slopes if entries else Slopes("", (), ()), apart=charge[1] == 0)


def add_force_at(
    assembly: Assembly, place: Place, rows: Sequence[Expr], *, counted: bool, torque: bool = False
) -> None:
    """Add a force [N], or torque [N m], with components ``rows`` (3) at a place on a body.

    Position and velocity in the formulas are those of the place; ``counted``: its power is counted as work.
    """
    from sceneql.system import Slopes

    for row in rows:
        assembly.stop_at_breakpoints(row)
    constants = Constants()
    printer = Printer(NAMES, {}, constants)
    forces = ", ".join(printer.name(row) for row in [constants.lift(row) for row in rows])
    lines = [
        f"    if floats[ints[{AT + 3}]] == 0.0:",
        "        return",
        *_motion_at(),
        *(f"    {line}" for line in printer.lines),
        f"    power = {'twist' if torque else 'push'}(y, out, floats, ints, {AT}, {forces})",
        *([f"    out[ints[{AT + 2}]] -= power"] if counted else []),
    ]
    imports = ("from sceneql.bodies.rigid.place_kernels import position, push, twist, velocity",)
    kernel = write_term("force_at", constants, AT + PLACE_INTS, lines, imports)
    inputs = [assembly.value(Value(expr)) for expr in constants.inputs]
    head = (assembly.floats(constants.values), place.bodies.mass_at + place.body)
    # As in `add_force`, the derivatives' constants are stored before a solver asks for the Jacobian.
    more, slopes_kernel = _slopes_at(rows, torque)
    values = [assembly.value(Value(expr)) for expr in more.inputs]
    ints = (assembly.floats(more.values), head[1], *place.ints, *values)

    def slopes() -> Slopes:
        from sceneql.bodies.rigid.place_slopes import force_places, torque_places

        places = torque_places(place.ints) if torque else force_places([(place.ints, place.ints)])
        return Slopes(slopes_kernel(), *places, ints)

    assembly.term("force", kernel, (*head, *place.ints, *inputs), slopes)


def _slopes_at(rows: Sequence[Expr], torque: bool) -> tuple[Constants, Callable[[], str]]:
    """Constants of the Jacobian of a force, or torque, at a place on a body, and a function that writes its kernel."""
    constants = Constants()
    printer = Printer(NAMES, {}, constants)
    forces = ", ".join(printer.name(constants.lift(row)) for row in rows)
    found = [differentiate(row, Symbol(name)) for row in rows for name in MOTION]
    names = [printer.name(constants.lift(expr)) for expr in found]
    added = "add_torque" if torque else "add_at_one"

    def kernel() -> str:
        lines = [
            f"    if floats[ints[{AT + 3}]] == 0.0:",
            "        return",
            *_motion_at(),
            *(f"    {line}" for line in printer.lines),
            f"    slopes = np.array([{', '.join(f'1.0 * ({name})' for name in names)}])",
            f"    {added}(y, floats, ints, {AT}, {forces}, slopes, out)",
        ]
        imports = (
            "from sceneql.bodies.rigid.place_kernels import position, velocity",
            "from sceneql.bodies.rigid.place_slopes_kernels import add_at_one, add_torque",
        )
        return write_term("force_at_slopes", constants, AT + PLACE_INTS, lines, imports)

    return constants, kernel


def _motion_at() -> list[str]:
    """Lines of a kernel that read position and velocity of a place on a body, and the body's mass."""
    return [
        f"    {', '.join(NAMES[name] for name in MOTION[:3])} = position(y, floats, ints, {AT})",
        f"    {', '.join(NAMES[name] for name in MOTION[3:])} = velocity(y, floats, ints, {AT})",
        "    own_m = floats[ints[1]]",
    ]


def _slopes(rows: Sequence[Expr]) -> tuple[list[tuple[int, int]], Callable[[], str], Constants]:
    """(pairs (component, index in MOTION) with a nonzero derivative, function that writes their kernel, constants)."""
    constants = Constants()
    printer = Printer(NAMES, {}, constants)
    found = [(c, n, differentiate(row, Symbol(name))) for c, row in enumerate(rows) for n, name in enumerate(MOTION)]
    entries = [(c, n, expr) for c, n, expr in found if expr != ZERO]
    names = [printer.name(constants.lift(expr)) for _, _, expr in entries]
    outputs = [f"out[{len(names)} * k + {i}] += {name}" for i, name in enumerate(names)]
    return [(c, n) for c, n, _ in entries], lambda: _kernel("force_slopes", printer, outputs), constants


def links_of(formula: Formula) -> list[Link]:
    """The links of a formula to outputs of other parts, each once."""
    return list(dict.fromkeys(node for node in walk(formula.expr) if isinstance(node, Link)))


def store_links(assembly: Assembly, formula: Formula) -> list[int]:
    """Store the outputs of other parts that a formula reads; returns the offset of each of `links_of`."""
    return [assembly.value(Value(link)) for link in links_of(formula)]


def potential_at(
    formula: Formula, places: Floats, state: ModelState, linked: Sequence[int], known: Mapping[str, Any] | None = None
) -> Floats:
    """Values (n,) of a potential at points (n, 3) [m].

    ``linked``: offsets from `store_links`; ``known``: values of further symbols.
    """
    import numpy as np

    offsets = dict(zip(links_of(formula), linked, strict=True))
    names: dict[str, Any] = {**dict(zip(PLACE, places.T, strict=True)), TIME_SYMBOL: state.t, **(known or {})}

    def look_up(node: Symbol | Link) -> Any:
        if isinstance(node, Symbol):
            return names[node.name]
        first = offsets[node]
        return state.floats[first : first + 3] if node.type.shape else state.floats[first]

    return np.broadcast_to(evaluate(components(formula.expr)[0], look_up, arrays=True), len(places))


def _kernel(function: str, printer: Printer, outputs: Sequence[str]) -> str:
    lines = [
        "    position_at, velocity_at, mass_at, inverse_at = ints[1], ints[2], ints[4], ints[5]",
        "    for k in range(ints[3]):",
        "        if floats[inverse_at + k] == 0.0:",
        "            continue",
        *(f"        {NAMES[name]} = y[position_at + 3 * k + {c}]" for c, name in enumerate(MOTION[:3])),
        *(f"        {NAMES[name]} = y[velocity_at + 3 * k + {c}]" for c, name in enumerate(MOTION[3:])),
        "        own_m = floats[mass_at + k]",
        "        own_q = floats[ints[7] + k * ints[8]]",
        *(f"        {line}" for line in (*printer.lines, *outputs)),
    ]
    return write_term(function, printer.constants, HEAD, lines)
