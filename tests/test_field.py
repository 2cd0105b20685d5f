"""Laws of the implicit-field engine: every evaluator over every operation, and roots that are proved."""

import math
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sceneql.field.builder import TapeBuilder
from sceneql.field.enclosure_kernels import segment
from sceneql.field.gradient_kernels import gradient
from sceneql.field.interval_kernels import box
from sceneql.field.isolation_kernels import any_root, exit_root, first_root
from sceneql.field.lowering import LOWERED
from sceneql.field.solid import cast, field_gradients, field_values, scratch
from sceneql.field.tape_kernels import value
from sceneql.field.tape_ops import (
    BINARY,
    HIT,
    INSIDE,
    MISS,
    NOWHERE,
    PARTIAL,
    UNARY,
    UNDECIDED,
    WHOLE,
    scratch_rows,
)
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Number, Symbol, Vector
from sceneql.quantities.operations import OPERATIONS
from search_kernels import searched

NAMES = sorted([*UNARY, *BINARY, "density", *LOWERED])
ARGUMENTS = dict.fromkeys(UNARY, 1) | dict.fromkeys(BINARY, 2)
TWO = ("mod", "hypot", "gt", "lt", "ge", "le", "eq", "step")
THREE = ("clamp", "mix", "smoothstep", "where", "density")
ARGUMENTS |= dict.fromkeys(LOWERED, 1) | dict.fromkeys(TWO, 2) | dict.fromkeys(THREE, 3)
JUMPS = ("floor", "sign", "ceil", "mod", "round", "step", "where", "gt", "lt", "ge", "le", "eq")
NUMBERS = st.floats(-3.0, 3.0).map(lambda number: round(number, 3) + 0.0)
COORDINATES = st.floats(-2.0, 2.0).map(lambda number: round(number, 6) + 0.0)
PARTS = np.array(
    [[0.2, 0.1, 0.0, 0.2, 0.1, 0.0, 0.9, 1.0], [-0.5, 0, 0.3, 0.6, 0.4, -0.3, 0.5, 0.7], [0, 0, 1, 0, 1, 1, 1.5, -0.5]]
)


def arguments(tape):
    return tape.code, tape.constants, tape.parts, scratch(tape)


@st.composite
def tapes(draw, most=8, names=tuple(NAMES)):
    """A random tape in which every operation may meet every other."""
    builder = TapeBuilder()
    registers = [builder.x, builder.y, builder.z, builder.constant(draw(NUMBERS)), builder.constant(draw(NUMBERS))]
    for _ in range(draw(st.integers(1, most))):
        name = draw(st.sampled_from(names))
        chosen = [draw(st.sampled_from(registers)) for _ in range(ARGUMENTS[name])]
        made = builder.density(PARTS, *chosen) if name == "density" else builder.op(name, *chosen)
        registers.append(made)
    return builder.finish(registers[-1])


@st.composite
def rays(draw):
    origin = [draw(COORDINATES) for _ in range(3)]
    direction = [draw(COORDINATES) for _ in range(3)]
    start = draw(COORDINATES)
    return (
        np.array(origin),
        np.array(direction),
        start,
        start + draw(st.sampled_from([0.0, 1e-9, 1e-4, 0.01, 0.3, 1.0, 4.0])),
    )


def of_one(name):
    """A tape of one operation, on arguments that move unequally."""
    builder = TapeBuilder()
    chosen = [builder.x, builder.y, builder.z][: ARGUMENTS[name]]
    made = builder.density(PARTS, *chosen) if name == "density" else builder.op(name, *chosen)
    return builder.finish(made)


def check_segment(tape, origin, direction, t0, t1):
    c0, c1, e, status = segment(*arguments(tape), *origin, *direction, t0, t1, True)
    again = segment(*arguments(tape), *origin, *direction, t0, t1, True)
    assert again == (c0, c1, e, status)
    tau = np.linspace(-1.0, 1.0, 41)
    t = 0.5 * (t0 + t1) + 0.5 * (t1 - t0) * tau
    f = field_values(tape, origin + t[:, None] * direction)
    defined = ~np.isnan(f)
    if status == WHOLE:
        assert defined.all()
    if status == NOWHERE:
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
    f = f[~np.isnan(f)] if status != WHOLE else f
    assert not (status == NOWHERE and len(f))
    assert ((f >= below) & (f <= above)).all(), (below, above, f.min(), f.max())


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=40)
@given(ray=rays())
def test_enclosure_of_every_operation_contains_its_values(name, ray):
    check_segment(of_one(name), *ray)


@settings(max_examples=500)
@given(tape=tapes(), ray=rays())
def test_enclosure_of_any_tape_contains_its_values(tape, ray):
    check_segment(tape, *ray)


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=25)
@given(ray=rays())
def test_interval_of_every_operation_contains_its_values(name, ray):
    low, size, _, width = ray
    check_box(of_one(name), low, low + np.abs(size) * abs(width))


@settings(max_examples=300)
@given(tape=tapes(), ray=rays())
def test_interval_of_any_tape_contains_its_values(tape, ray):
    low, size, _, width = ray
    check_box(tape, low, low + np.abs(size) * abs(width))


@settings(max_examples=300)
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


SMOOTH = ("add", "sub", "mul", "square", "sin", "cos", "density", "min", "max", "abs", "neg")


@settings(max_examples=300)
@given(tape=tapes(), ray=rays())
def test_no_crossing_is_missed_and_none_invented(tape, ray):
    origin, direction, t0, t1 = ray
    status, t = first_root(*arguments(tape), *origin, *direction, t0, t1, 1e-9)
    blocked = any_root(*arguments(tape), *origin, *direction, t0, t1, 1e-9)
    places = np.linspace(t0, t1, 801)
    inside = field_values(tape, origin + places[:, None] * direction) < 0.0
    near = 1e-9 * (t1 - t0) + 1e-14
    if inside.any():
        assert status != MISS
        assert blocked != MISS
        assert t <= places[np.argmax(inside)] + near
    if status == INSIDE:
        assert t == t0
        assert inside[0]
    if status == HIT:
        around = np.clip(t + near * np.array([0.0, 1e-3, 0.1, 1.0, 2.0]), t0, t1)
        assert (field_values(tape, origin + around[:, None] * direction) < 0.0).any()
    if status == MISS:
        assert blocked == MISS
    if status in (HIT, INSIDE):
        assert blocked != MISS


@settings(max_examples=200)
@given(tape=tapes(names=SMOOTH), ray=rays())
def test_the_way_out_is_the_way_into_the_negated_field(tape, ray):
    origin, direction, t0, t1 = ray
    status, t = exit_root(*arguments(tape), *origin, *direction, t0, t1, 1e-9)
    places = np.linspace(t0, t1, 401)
    outside = field_values(tape, origin + places[:, None] * direction) > 0.0
    assert not (status == MISS and outside.any())
    if outside.any():
        assert t <= places[np.argmax(outside)] + 1e-9 * (t1 - t0) + 1e-14


def implicit(formula):
    """The tape of a formula of a builder's own operations."""
    builder = TapeBuilder()
    return builder.finish(formula(builder, builder.op, builder.constant))


def sphere(radius):
    def formula(b, op, c):
        squares = [op("square", register) for register in (b.x, b.y, b.z)]
        return op("sub", op("add", op("add", squares[0], squares[1]), squares[2]), c(radius**2))

    return implicit(formula)


def kernels(centers, threshold, radius=1.0):
    parts = np.array([[*center, *center, radius, 1.0] for center in centers], dtype=float)
    return implicit(lambda b, op, c: op("sub", c(threshold), b.density(parts, b.x, b.y, b.z)))


def fan(count=200, spread=1.2, seed=5):
    """Rays from z = 6 that look at a square about the middle."""
    generator = np.random.default_rng(seed)
    origins = np.column_stack([generator.uniform(-spread, spread, (count, 2)), np.full(count, 6.0)])
    targets = np.column_stack([generator.uniform(-spread, spread, (count, 2)), np.zeros(count)])
    directions = targets - origins
    return origins, directions / np.linalg.norm(directions, axis=1)[:, None]


def test_sphere_roots_are_exact():
    origins, directions = fan()
    status, t = cast(sphere(0.8), origins, directions, 0.0, 12.0)
    along = -np.einsum("ij,ij->i", origins, directions)
    left = 0.64 - (np.einsum("ij,ij->i", origins, origins) - along**2)
    assert ((status == HIT) == (left > 0)).all()
    assert (status != UNDECIDED).all()
    hit = status == HIT
    assert t[hit] == pytest.approx(along[hit] - np.sqrt(left[hit]), rel=1e-12)


def test_torus_roots_are_exact():
    def formula(b, op, c):
        ring = op("sub", op("sqrt", op("add", op("square", b.x), op("square", b.z))), c(1.0))
        return op("sub", op("add", op("square", ring), op("square", b.y)), c(0.16))

    origins, directions = fan(spread=1.6)
    status, t = cast(implicit(formula), origins, directions, 0.0, 12.0)
    # (p^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + z^2) along a ray is a quartic.
    for o, d, s, found in zip(origins, directions, status, t, strict=True):
        whole = np.polynomial.Polynomial([o @ o + 1.0 - 0.16, 2 * o @ d, 1.0])
        flat = np.polynomial.Polynomial([o[0] ** 2 + o[2] ** 2, 2 * (o[0] * d[0] + o[2] * d[2]), d[0] ** 2 + d[2] ** 2])
        roots = (whole * whole - 4.0 * flat).roots()
        real = sorted(root.real for root in roots if abs(root.imag) < 1e-9)
        assert (s == HIT) == bool(real)
        if real:
            assert found == pytest.approx(real[0], rel=1e-9)


def test_radius_of_one_kernel():
    status, t = cast(kernels([(0, 0, 0)], 0.3), [[0, 0, 5]], [[0, 0, -1]], 0.0, 10.0)
    assert status[0] == HIT
    assert 5.0 - t[0] == pytest.approx(math.sqrt(1.0 - 0.3 ** (1 / 3)), abs=1e-12)
    assert 5.0 - t[0] == pytest.approx(0.5749496064, abs=1e-10)


@pytest.mark.parametrize(("gap", "merged"), [(-1e-8, True), (1e-8, False)])
def test_two_kernels_merge_at_their_exact_distance(gap, merged):
    radius = 0.7
    apart = radius * 2.0 * math.sqrt(1.0 - 0.15 ** (1 / 3))
    assert apart / radius == pytest.approx(1.3691905863, abs=1e-10)
    apart *= 1.0 + gap
    tape = kernels([(-apart / 2, 0, 0), (apart / 2, 0, 0)], 0.3, radius)
    status, _ = cast(tape, [[0, 0, 4]], [[0, 0, -1]], 0.0, 8.0)
    assert status[0] == (HIT if merged else MISS)


def test_thin_shell_is_whole_and_its_four_roots_are_exact():
    radius, thickness = 0.7, 1e-3

    def formula(b, op, c):
        squares = [op("square", register) for register in (b.x, b.y, b.z)]
        r = op("sqrt", op("add", op("add", squares[0], squares[1]), squares[2]))
        return op("sub", op("abs", op("sub", r, c(radius))), c(thickness / 2))

    tape = implicit(formula)
    for b in np.linspace(0.0, 0.7, 101):
        outer = math.sqrt((radius + thickness / 2) ** 2 - b * b)
        expected = [2.0 - outer]
        if b < radius - thickness / 2:
            inner = math.sqrt((radius - thickness / 2) ** 2 - b * b)
            expected += [2.0 - inner, 2.0 + inner]
        expected += [2.0 + outer]
        found, start = [], 0.0
        for function in [first_root, exit_root] * (len(expected) // 2):
            status, t = function(*arguments(tape), b, 0.0, 2.0, 0.0, 0.0, -1.0, start, 4.0, 1e-9)
            assert status == HIT
            found.append(t)
            start = t + 1e-6
        assert found == pytest.approx(expected, abs=1e-11)


def test_a_double_root_is_no_way_in():
    def squared(b, op):
        squares = [op("square", register) for register in (b.x, b.y, b.z)]
        return op("add", op("add", squares[0], squares[1]), squares[2])

    ray = [[0.1, 0.2, 3]], [[0, 0, -1]], 0.0, 6.0
    factored = implicit(lambda b, op, c: op("square", op("sub", squared(b, op), c(0.49))))
    assert cast(factored, *ray)[0][0] == MISS
    # Where rounding makes values below zero of r^4 - 0.98 r^2 + 0.2401 there, that is not known.
    expanded = implicit(
        lambda b, op, c: op("add", op("mul", squared(b, op), op("sub", squared(b, op), c(0.98))), c(0.2401))
    )
    status, t = cast(expanded, *ray)
    assert status[0] == UNDECIDED
    assert t[0] == pytest.approx(3.0 - math.sqrt(0.49 - 0.05), abs=1e-6)


@pytest.mark.parametrize("length", [1e-9, 1.0, 1e3])
def test_a_touch_at_the_start_is_no_hit(length):
    tape = implicit(lambda b, op, c: op("square", b.z))
    assert cast(tape, [[0, 0, 0]], [[0, 0, 1]], 0.0, length)[0][0] in (MISS, UNDECIDED)


def test_what_is_undefined_stays_so():
    tape = implicit(lambda b, op, c: op("pow", op("sqrt", b.x), b.y))
    assert np.isnan(field_values(tape, [[-1.0, 0.0, 0.0]])[0])


def test_a_capsule_of_the_field_is_round_and_straight():
    parts = np.array([[-0.5, 0, 0, 0.5, 0, 0, 0.6, 1.0]])
    tape = implicit(lambda b, op, c: op("sub", c(0.3), b.density(parts, b.x, b.y, b.z)))
    reach = 0.6 * 0.57494960639
    x = np.array([-0.5 - 0.9 * reach, -0.4, 0.0, 0.3, 0.5 + 0.5 * reach, 0.5 + 1.01 * reach])
    origins = np.column_stack([x, np.zeros(6), np.full(6, 3.0)])
    status, t = cast(tape, origins, np.array([[0, 0, -1.0]]), 0.0, 6.0)
    beyond = np.maximum(np.abs(x) - 0.5, 0.0)
    assert status.tolist() == [HIT] * 5 + [MISS]
    assert 3.0 - t[:5] == pytest.approx(np.sqrt(reach**2 - beyond[:5] ** 2), abs=1e-10)


def test_where_a_field_is_undefined_is_outside():
    tape = implicit(lambda b, op, c: op("sub", op("sqrt", b.z), c(2.0)))
    status, t = cast(tape, [[0, 0, 1]], [[0, 0, 1]], -4.0, 1.0)
    assert status[0] == HIT
    assert t[0] == pytest.approx(-1.0, abs=1e-8)
    logarithm = implicit(lambda b, op, c: op("log", op("sub", b.x, c(10.0))))
    assert cast(logarithm, [[0, 0, 1]], [[1, 0, 0]], 0.0, 9.0)[0][0] == MISS


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e200])
def test_nothing_is_claimed_of_what_is_not_finite(bad):
    tape = implicit(lambda b, op, c: op("mul", op("square", b.x), op("square", b.y)))
    for where in [(bad, 0.0, 0.0), (0.0, bad, 0.0)]:
        _, _, e, status = segment(*arguments(tape), *where, 1.0, 1.0, 0.0, -1.0, 1.0, True)
        assert (e, status) == (math.inf, PARTIAL)
    low, high, status = box(*arguments(tape), 0.0, bad, 0.0, bad, 0.0, 1.0)
    assert (low <= 0.0, high, status) == (True, math.inf, PARTIAL)
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
    return not (vectors or reduces or operation.series or name == "random")


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
    assert scratch(tape).shape[0] == scratch_rows(len(tape.code), 3)


PLAIN_PYTHON = """
import numpy as np
from sceneql.field.builder import TapeBuilder
from sceneql.field.lowering import LOWERED
from sceneql.field.solid import cast, field_values, scratch
from sceneql.field.interval_kernels import box
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


@pytest.mark.parametrize("noise", [0.0, 1e3, 1e4, 1e5])
def test_a_bracket_within_the_tolerance_is_a_hit_though_rounding_leaves_none_narrower(noise):
    # x + noise - noise is known to noise 1e-16 alone: enclosures end there, and needed the certified intervals.
    def plane(build, op, c):
        return op("sub", op("add", op("sub", c(0.3), build.x), c(noise)), c(noise))

    tape = implicit(plane)
    where = np.array([-1.0, 0.1, 0.2]), np.array([1.0, 0.3, -0.2])
    for tolerance in (1e-9, 1e-8, 1e-6):
        program = tape.code, tape.constants, tape.parts, scratch(tape), *where
        status, t = searched(*program, 0.0, 2.0, tolerance, False)
        assert status == HIT
        assert t == pytest.approx(1.3, abs=2.0 * tolerance)
        assert searched(*program, 0.0, 1.3 - 2.0 * tolerance, tolerance, False)[0] == MISS


def test_what_rounding_hides_beyond_the_tolerance_is_left_to_the_certified_intervals():
    tape = implicit(lambda build, op, c: op("sub", op("add", op("sub", c(0.3), build.x), c(1e9)), c(1e9)))
    ray = np.array([-1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]), 0.0, 2.0, 1e-9
    status, t = searched(tape.code, tape.constants, tape.parts, scratch(tape), *ray, False)
    assert status == UNDECIDED
    assert t < 1.3
