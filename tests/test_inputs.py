"""Values that vary in time: the compiled programs give what the expressions give, at any time, inside a march too."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from islands import assembly
from sceneql.island.inputs_kernels import BINARY, CODES, UNARY, refresh
from sceneql.island.lowering import LOWERINGS
from sceneql.kinds import Value
from sceneql.march.march import March
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import SCALAR, Call, Expr, Key, Keys, Link, Number, Symbol, Type, Vector
from sceneql.quantities.operations import OPERATIONS
from sceneql.stepping.tableau import CLASSIC

TIME = Symbol("time")
VECTOR = Type((3,))


def numbers(*values: float) -> tuple[Number, ...]:
    return tuple(Number(v) for v in values)


def program_value(expr: Expr, t: float, y: np.ndarray | None = None, **settings: object) -> np.ndarray:
    """What the compiled program makes of an expression at a time."""
    island = assembly(settings.get("formulas"))
    island.state(np.zeros(4) if y is None else y)
    island.places = settings.get("places", island.places)
    first = island.value(Value(expr))
    size = math.prod(expr.type.shape)
    system = island.finish()
    block = system.ints[system.ints[2] :]
    refresh(t, system.y, system.floats, system.ints[block[0] : block[1]])
    return system.floats[first : first + size].reshape(expr.type.shape)


def agree(expr: Expr, t: float) -> None:
    expected = np.asarray(evaluate(expr, {TIME: t}, arrays=True))
    np.testing.assert_allclose(program_value(expr, t), expected, rtol=1e-14, atol=1e-300)


def test_every_scalar_operation_is_compiled_or_lowered_or_said_not_to_be():
    left = {"component", "item", "count", "hue", "random"} | {name for name, op in OPERATIONS.items() if op.series}
    assert set(OPERATIONS) == set(CODES) | set(LOWERINGS) | left


@pytest.mark.parametrize("name", UNARY)
@given(t=st.floats(-40, 40))
def test_operations_on_one_number_agree(name, t):
    agree(Call(name, (TIME,)), t)


@pytest.mark.parametrize("name", BINARY)
@given(t=st.floats(-40, 40), other=st.floats(-5, 5) | st.sampled_from([0.0, 1.0, 2.0, -1.0]))
def test_operations_on_two_numbers_agree(name, t, other):
    agree(Call(name, (TIME, Number(other))), t)


@pytest.mark.parametrize(
    ("name", "more"),
    [("clamp", (1.0, 2.0)), ("mix", (3.0, 0.25)), ("smoothstep", (1.0, 0.5)), ("ease", ()), ("step", (0.5,)),
     ("hypot", (2.0,)), ("noise", ()), ("where", (1.0, 2.0)), ("min", (2.0, 1.0)), ("max", (-1.0, 0.0, 1.0))],
)  # fmt: skip
@given(t=st.floats(-3, 3))
def test_derived_operations_agree(name, more, t):
    agree(Call(name, (TIME, *numbers(*more))), t)


@given(t=st.floats(-5, 5))
def test_vectors_and_rotations_agree(t):
    moving = Vector((TIME, Number(2.0), Call("sin", (TIME,))), VECTOR)
    other = Vector(numbers(0.5, -1.0, 3.0), VECTOR)
    turn = Type((4,))
    for op, args, kind in (
        ("add", (moving, other), VECTOR),
        ("mul", (moving, TIME), VECTOR),
        ("cross", (moving, other), VECTOR),
        ("normalize", (moving,), VECTOR),
        ("dot", (moving, other), SCALAR),
        ("length", (moving,), SCALAR),
        ("distance", (moving, other), SCALAR),
        ("sum", (moving,), SCALAR),
        ("mean", (moving,), SCALAR),
        ("max", (moving,), SCALAR),
        ("component", (moving, Number(2.0)), SCALAR),
        ("noise", (moving,), SCALAR),
        ("noise", (Vector(moving.items[1:], Type((2,))),), SCALAR),
        ("about", (other, TIME), turn),
        ("euler_xyz", (moving,), turn),
        ("turn", (Call("about", (other, TIME), turn), Call("euler_zyx", (moving,), turn)), turn),
    ):
        agree(Call(op, args, kind), t)


SLOPED = (
    Key(Number(0.0), Number(1.0), None, Number(4.0)),
    Key(Number(1.0), Number(-2.0), Number(0.5)),
    Key(*numbers(3, 0)),
)


@pytest.mark.parametrize("curve", ["step", "linear", "smooth", "cubic"])
@pytest.mark.parametrize("cycle", [None, Number(3.0)])
@given(t=st.floats(-7, 7) | st.sampled_from([0.0, 1.0, 3.0]))
def test_keyframes_agree(curve, cycle, t):
    agree(Keys(TIME, SLOPED, curve, cycle), t)
    points = tuple(Key(Number(float(k)), Vector(numbers(k, k * k, 1.0), VECTOR)) for k in range(3))
    agree(Keys(TIME, points, curve, cycle, VECTOR), t)
    angles = (0.0, 1.0, 4.0)
    axis = Vector(numbers(0, 1, 1), VECTOR)
    turns = tuple(Key(Number(a), Call("about", (axis, Number(a)), Type((4,)))) for a in angles)
    if curve != "step":
        agree(Keys(TIME, turns, curve, cycle, Type((4,))), t)


def test_an_output_of_a_kinematic_model_is_its_formula_and_one_of_a_solved_model_is_its_entries():
    link = Link("path", "position", VECTOR)
    formula = Vector((TIME, Number(1.0), Number(2.0)), VECTOR)
    value = program_value(Call("mul", (link, Number(2.0)), VECTOR), 3.0, formulas={"path.position": formula})
    assert value.tolist() == [6.0, 2.0, 4.0]

    y = np.array([5.0, 6.0, 7.0, 8.0])
    assert program_value(link, 0.0, y, places=lambda _: np.array([1, 2, 3])).tolist() == [6.0, 7.0, 8.0]
    with pytest.raises(ScriptError, match="no part of the state"):
        program_value(link, 0.0)


def test_what_cannot_vary_is_said():
    with pytest.raises(ScriptError, match="random"):
        program_value(Call("random", (TIME,)), 0.0)


def test_a_varying_value_is_read_at_stage_times():
    # x'' = -floats = cos t, from rest at -1: x = -cos t; evaluated at the steps' starts it would be of order 1
    island = assembly()
    island.state([-1.0, 0.0])
    varying = island.value(Value(Call("neg", (Call("cos", (TIME,)),))))
    island.term("internal", "solver_kernels:heights", (varying,))
    system = island.finish()
    errors = [abs(March(system, CLASSIC.fixed(h), 2.0).advance(2.0)[0][0] + math.cos(2.0)) for h in (0.1, 0.05)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.2)
    march = March(system, CLASSIC.fixed(0.3), 2.0)
    y, _ = march.advance(0.7)
    assert march.floats_at(0.7, y)[varying] == -math.cos(0.7)
