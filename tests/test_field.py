"""Laws of the evaluators of implicit fields: every one over every operation, and over random tapes."""

import math
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import examples
from plain_tapes import fan, implicit
from random_tapes import ARGUMENTS, COORDINATES, JUMPS, NAMES, NUMBERS, PARTS, arguments, of_one, rays, tapes
from sceneql.field.enclose.enclosure_kernels import segment
from sceneql.field.enclose.interval_kernels import box
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.gradient_kernels import gradient
from sceneql.field.tape.tape_kernels import value
from sceneql.field.tape.tape_solid import cast, field_gradients, field_values, scratch
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Number, Symbol, Vector
from sceneql.quantities.operations import OPERATIONS


def check_segment(tape, origin, direction, t0, t1):
    c0, c1, e, status = segment(*arguments(tape), *origin, *direction, t0, t1, True)
    again = segment(*arguments(tape), *origin, *direction, t0, t1, True)
    assert again == (c0, c1, e, status)
    tau = np.linspace(-1.0, 1.0, 41)
    t = 0.5 * (t0 + t1) + 0.5 * (t1 - t0) * tau
    f = field_values(tape, origin + t[:, None] * direction)
    defined = ~np.isnan(f)
    if status == ops.WHOLE:
        assert defined.all()
    if status == ops.NOWHERE:
        assert not defined.any()
    elif e < math.inf:
        off = np.abs(f - (c0 + c1 * tau))[defined]
        assert (off <= e).all(), (off.max(), e)
    assert e >= 0.0


def check_box(tape, low, high):
    below, above, status = box(*arguments(tape), low[0], high[0], low[1], high[1], low[2], high[2])
    corners = np.array([low, high])
    grid = np.stack(np.meshgrid(*[np.linspace(*corners[:, k], 6) for k in range(3)]), axis=-1).reshape(-1, 3)
    f = field_values(tape, grid)
    f = f[~np.isnan(f)] if status != ops.WHOLE else f
    assert not (status == ops.NOWHERE and len(f))
    assert ((f >= below) & (f <= above)).all(), (below, above, f.min(), f.max())


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=40)
@given(ray=rays())
def test_enclosure_of_every_operation_contains_its_values(name, ray):
    check_segment(of_one(name), *ray)


@settings(max_examples=examples(500))
@given(tape=tapes(), ray=rays())
def test_enclosure_of_any_tape_contains_its_values(tape, ray):
    check_segment(tape, *ray)


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=25)
@given(ray=rays())
def test_interval_of_every_operation_contains_its_values(name, ray):
    low, size, _, width = ray
    check_box(of_one(name), low, low + np.abs(size) * abs(width))


@settings(max_examples=examples(300))
@given(tape=tapes(), ray=rays())
def test_interval_of_any_tape_contains_its_values(tape, ray):
    low, size, _, width = ray
    check_box(tape, low, low + np.abs(size) * abs(width))


@settings(max_examples=examples(300))
@given(tape=tapes(most=5), point=st.tuples(COORDINATES, COORDINATES, COORDINATES))
def test_gradient_agrees_with_differences(tape, point):
    h = 1e-5
    point = np.add(point, (0.0173205, 0.0141421, 0.0223606))  # off the ties that round numbers make
    steps = np.concatenate([h * np.eye(3), -h * np.eye(3), 2 * h * np.eye(3), -2 * h * np.eye(3), np.zeros((1, 3))])
    f = field_values(tape, point + steps)
    found, *slope = gradient(*arguments(tape), *point)
    assert found == f[12] or (math.isnan(found) and math.isnan(f[12]))
    if not (np.isfinite(f).all() and np.abs(f).max() < 1e4):
        return
    central, wide, second = (f[:3] - f[3:6]) / (2 * h), (f[6:9] - f[9:12]) / (4 * h), f[:3] + f[3:6] - 2 * f[12]
    smooth = (np.abs(central - wide) < 1e-6 * (1 + np.abs(central))) & (np.abs(second) < 1e-6 * (1 + np.abs(central)))
    undefined = np.isnan(slope)
    if (
        undefined.any()
    ):  # there is no slope where a step on the way is infinite, though the end be finite: atan2(1/0, 1)
        assert not np.isfinite([field_values(replace(tape, code=tape.code[:k]), point[None]) for k in rows(tape)]).all()
    smooth &= ~undefined
    assert np.abs(np.array(slope) - central)[smooth] == pytest.approx(0.0, abs=1e-4 * (1 + np.abs(central).max()))


def rows(tape):
    """Lengths of the beginnings of a tape."""
    return range(1, len(tape.code) + 1)


def test_a_slope_is_undefined_behind_an_infinite_step():
    build = TapeBuilder()
    one = build.constant(1.0)
    tape = build.finish(build.op("atan2", build.op("log", build.constant(0.0)), one))
    found, *slope = gradient(*arguments(tape), 0.1, 0.2, 0.3)
    assert found == pytest.approx(-math.pi / 2)
    assert np.isnan(slope).all()


@pytest.mark.parametrize("name", [name for name in NAMES if name not in JUMPS])
def test_gradient_of_every_operation(name):
    point = np.array([0.35, 0.2, 0.6])
    h = 1e-6
    f = field_values(of_one(name), np.concatenate([point + h * np.eye(3), point - h * np.eye(3)]))
    assert field_gradients(of_one(name), point[None])[0] == pytest.approx((f[:3] - f[3:]) / (2 * h), abs=1e-7, rel=1e-7)


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e200])
def test_nothing_is_claimed_of_what_is_not_finite(bad):
    tape = implicit(lambda b, op, c: op("mul", op("square", b.x), op("square", b.y)))
    for where in [(bad, 0.0, 0.0), (0.0, bad, 0.0)]:
        _, _, e, status = segment(*arguments(tape), *where, 1.0, 1.0, 0.0, -1.0, 1.0, True)
        assert (e, status) == (math.inf, ops.PARTIAL)
    low, high, status = box(*arguments(tape), 0.0, bad, 0.0, bad, 0.0, 1.0)
    assert (low <= 0.0, high, status) == (True, math.inf, ops.PARTIAL)
    assert box(*arguments(tape), 1.0, 0.0, 0.0, 1.0, 0.0, 1.0)[:2] == (-math.inf, math.inf)


def test_code_is_shared_folded_and_lowered():
    builder = TapeBuilder()
    cube = builder.op("pow", builder.x, builder.constant(3.0))
    assert cube == builder.op("mul", builder.x, builder.op("square", builder.x))
    assert builder.op("add", builder.x, builder.y) == builder.op("add", builder.y, builder.x)
    assert builder.op("add", builder.constant(2.0), builder.constant(3.0)) == builder.constant(5.0)
    assert builder.op("mul", builder.x, builder.x) == builder.op("square", builder.x)
    tape = builder.finish(builder.op("pow", builder.x, builder.constant(-2.0)))
    assert len(tape.code) == 4
    assert len(tape.constants) == 1
    assert field_values(tape, [[4.0, 0, 0]])[0] == 1 / 16
    with pytest.raises(ValueError, match="no tape operation is named 'frobnicate'"):
        builder.op("frobnicate", builder.x)


def _of_numbers(name, operation):
    """Whether an operation takes and gives single numbers, and a field can have it."""
    vectors = any(operation.vector_args) or operation.vector_result or name in ("component", "item")
    reduces = operation.reduces and name not in ("min", "max")
    return not (vectors or reduces or operation.series or operation.part_of or name in ("random", "noise"))


@pytest.mark.parametrize("name", [name for name, operation in OPERATIONS.items() if _of_numbers(name, operation)])
@settings(max_examples=20)
@given(numbers=st.tuples(COORDINATES, COORDINATES, COORDINATES))
def test_tapes_agree_with_the_expressions_of_scripts(name, numbers):
    symbols = ("x", "y", "z")[: ARGUMENTS[name]]
    expr = Call(name, tuple(map(Symbol, symbols)))
    builder = TapeBuilder()
    register = builder.expression(expr, dict(zip("xyz", (builder.x, builder.y, builder.z), strict=True)))
    expected = evaluate(expr, dict(zip(map(Symbol, "xyz"), numbers, strict=True)))
    found = field_values(builder.finish(register), [numbers])[0]
    halfway = name == "round" and (numbers[0] - 0.5).is_integer()  # the tape rounds these up
    turns = numbers[0] / numbers[1] if name == "mod" and numbers[1] else 0.5  # at whole ones mod jumps
    halfway |= abs(turns - round(turns)) < 1e-12 * abs(turns)
    if math.isfinite(expected) and not halfway and not (name in ("pow", "smoothstep") and math.isnan(found)):
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_min_and_max_take_any_number():
    builder = TapeBuilder()
    three = builder.op("max", builder.x, builder.y, builder.z)
    assert field_values(builder.finish(three), [[1.0, 5.0, 3.0]])[0] == 5.0
    assert builder.op("min", builder.x) == builder.x


def test_expressions_become_tapes():
    builder = TapeBuilder()
    x, phi = Symbol("x"), Symbol("phi")
    expr = Call("sub", (Call("pow", (x, Number(2.0))), Call("mul", (phi, Number(3.0)))))
    tape = builder.finish(builder.expression(expr, {"x": builder.x, "phi": builder.y}))
    assert field_values(tape, [[2.0, 0.5, 0.0]])[0] == 2.5
    with pytest.raises(ValueError, match="no scalar"):
        builder.expression(Vector((x, x)), {"x": builder.x})


@settings(max_examples=50)
@given(numbers=st.lists(NUMBERS, min_size=12, max_size=12), point=st.tuples(COORDINATES, COORDINATES, COORDINATES))
def test_densities_move_with_affine_maps(numbers, point):
    matrix = np.array(numbers).reshape(3, 4)
    builder = TapeBuilder()
    moved = builder.affine(matrix, builder.x, builder.y, builder.z)
    tape = builder.finish(builder.density(PARTS, *moved))
    plain = TapeBuilder()
    fixed = plain.finish(plain.density(PARTS, plain.x, plain.y, plain.z))
    there = matrix[:, :3] @ np.array(point) + matrix[:, 3]
    assert field_values(tape, [point])[0] == pytest.approx(field_values(fixed, [there])[0], abs=1e-12)


def test_density_parts_of_many_fields_stay_apart():
    builder = TapeBuilder()
    first = builder.density(PARTS[:1], builder.x, builder.y, builder.z)
    second = builder.density(PARTS[1:], builder.x, builder.y, builder.z)
    tape = builder.finish(builder.op("sub", builder.constant(0.3), builder.op("add", first, second)))
    plain = implicit(lambda b, op, c: op("sub", c(0.3), b.density(PARTS, b.x, b.y, b.z)))
    origins, directions = fan(100)
    (status, t), (expected, place) = (cast(one, origins, directions, 0.0, 12.0) for one in (tape, plain))
    assert (status == expected).all()
    assert t == pytest.approx(place, abs=1e-11)
    assert scratch(tape).shape[0] == ops.scratch_rows(len(tape.code), 3)


PLAIN_PYTHON = """
import numpy as np
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.lowered_operations import LOWERED
from sceneql.field.tape.tape_solid import cast, field_values, scratch
from sceneql.field.enclose.interval_kernels import box
b = TapeBuilder()
parts = np.array([[-0.3, 0, 0, 0.3, 0, 0, 0.6, 1.0], [0, 0.4, 0, 0, 0.4, 0, 0.5, 1.0]])
wave = b.op("sin", b.op("mul", b.constant(9.0), b.x))
tape = b.finish(b.op("max", b.op("sub", b.constant(0.3), b.density(parts, b.x, b.y, b.z)), wave))
o = np.array([[-0.3, 0.0, 3.0], [-0.05, 0.3, 3.0], [0.2, 0.0, 3.0], [3.0, 3.0, 3.0]])
status, t = cast(tape, o, np.array([[0.0, 0.0, -1.0]]), 0.0, 6.0)
bounds = box(tape.code, tape.constants, tape.parts, scratch(tape), 0.0, 0.1, 0.0, 0.1, 0.0, 0.1)
print([float(number) for number in [*status, *t, *field_values(tape, o / 9), *bounds]])
"""


def test_plain_python_gives_the_same_bits():
    outputs = []
    for disabled in ("0", "1"):
        environment = {**os.environ, "NUMBA_DISABLE_JIT": disabled, "PYTHONWARNINGS": "ignore"}
        run = subprocess.run(
            [sys.executable, "-c", PLAIN_PYTHON], env=environment, capture_output=True, text=True, check=True
        )
        outputs.append(run.stdout)
    assert outputs[0] == outputs[1]
    assert outputs[0].startswith("[1.0, 1.0, 0.0, 0.0")


def test_value_is_that_of_the_formula():
    tape = implicit(lambda b, op, c: op("atan2", op("exp", b.x), op("tanh", op("sub", b.y, b.z))))
    assert value(*arguments(tape), 0.3, 0.2, 0.7) == pytest.approx(
        math.atan2(math.exp(0.3), math.tanh(-0.5)), rel=1e-15
    )
