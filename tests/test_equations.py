"""What `equations` promises: the mathematics of the script, its derivative, and code that depends on its form alone."""

from __future__ import annotations

import ast
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.integrate import solve_ivp

from islands import assembly
from runs import watch
from sceneql import pipeline
from sceneql.compiled import generated, kernels
from sceneql.compiled.generated import function
from sceneql.compiled.printer import TEXTS
from sceneql.formulas.rate_program import RateSystem, jacobian_kernel, rate_kernel
from sceneql.kinds import Formula
from sceneql.march.march import March
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Link, Number, Symbol
from sceneql.quantities.parser import parse_expression
from sceneql.quantities.span import Source, Span
from sceneql.system import ModelState
from sceneql.words.models.equations import Copies, Equations
from sceneql.words.solvers.dopri5 import Dopri5
from sceneql.words.solvers.rk4 import Rk4

DOUBLE_PENDULUM = {
    "start": {"a": "90 deg", "b": "90 deg", "a'": "0", "b'": "0"},
    "where": {"d": "a - b"},
    "rate": {
        "a''": "(-b'^2*sin(d) - 2*g/l*sin(a) - cos(d)*(a'^2*sin(d) - g/l*sin(b)))/(2 - cos(d)^2)",
        "b''": "(2*(a'^2*sin(d) - g/l*sin(b)) + cos(d)*(b'^2*sin(d) + 2*g/l*sin(a)))/(2 - cos(d)^2)",
    },
    "invariants": {"energy": "l^2*(a'^2 + b'^2/2 + a'*b'*cos(d)) - g*l*(2*cos(a) + cos(b))"},
    "gives": {"elbow": "[l*sin(a), -l*cos(a), 0]", "height": "-l*cos(a)"},
}
SPRING = {"start": {"x": "i + 1", "x'": "0"}, "rate": {"x''": "-k*x"}}


def bound(text, symbols, **defines):
    """A formula as the checker binds it."""
    span, found = Span(Source("scene.yaml", text), 0, len(text)), Diagnostics()

    def look_up(parts, place):
        if parts[0] in symbols:
            return Symbol("time" if parts[0] == "t" else parts[0], span=place)
        return Number(float(defines[parts[0]]), span=place)

    expr = bind(parse_expression(text, span), look_up, found)
    found.raise_errors()
    return Formula(expr, span)


def equations(written, copies=None, **defines):
    fields = written if copies is None else {**written, "copies": {"count": str(copies)}}
    symbols = Equations.formula_symbols(fields)

    def formulas(rows):
        return {name: bound(text, symbols, **defines) for name, text in rows.items()}

    exprs = {key + "_" * (key == "gives"): formulas(rows) for key, rows in written.items()}
    return Equations(**exprs, copies=None if copies is None else Copies(count=copies))


def laid_out(model, formulas=None):
    """The model's island, and where it was put."""
    island = assembly(formulas)
    with island.word("model", None):
        model.assemble("model", island)
    return island.finish(), island.remembered("model")


def marched(model, solver, end):
    """State of the model at the end."""
    system, ints = laid_out(model)
    march = March(system, solver.stepper(), end)
    y, rate = march.advance(end)
    return ModelState(end, y, rate, march.floats_at(end, y), None, ints)


def program(model):
    rows = model.rows
    return RateSystem(tuple(rows.states), tuple(rows.rates()), rows.where, rows.index)


def called(kernel, y, size, t=0.0):
    out = np.zeros(size)
    function(kernel.name)(t, np.array(y, dtype=float), out, np.array([*kernel.constants, 0.0]), np.array([0, 0, 1]))
    return out


def source(kernel):
    return Path(generated.load(kernel.name.partition(":")[0]).__file__).read_text(encoding="utf-8")


# --- the mathematics -------------------------------------------------------------------------------------------------


def test_the_double_pendulum_is_where_an_independent_run_finds_it():
    model = equations(DOUBLE_PENDULUM, l=1, g=9.81)
    state = marched(model, Dopri5(tolerance=1e-12), 2.0)
    known = {"a": -0.482971534252, "b": -1.324048712302, "a'": 3.065288192073, "b'": 2.949271547572}
    for name, value in known.items():
        assert model.read(name, state) == pytest.approx(value, abs=1e-9)


def test_a_mild_van_der_pol_oscillator_goes_as_scipy_says():
    model = equations({"start": {"y": "2", "z": "0"}, "rate": {"y": "z", "z": "((1 - y^2)*z - y)/m"}}, m=0.2)
    state = marched(model, Dopri5(tolerance=1e-11), 5.0)

    def rate(t, y):
        return [y[1], ((1 - y[0] ** 2) * y[1] - y[0]) / 0.2]

    other = solve_ivp(rate, (0, 5), [2, 0], method="DOP853", rtol=1e-12, atol=1e-12)
    assert [model.read("y", state), model.read("z", state)] == pytest.approx(list(other.y[:, -1]), rel=1e-8)


def test_the_second_order_form_is_the_first_order_form():
    second = equations(DOUBLE_PENDULUM, l=1, g=9.81)
    names = {"a''": "u", "b''": "v"}

    def first_order(text):
        return text.replace("a'", "u").replace("b'", "v")

    rows = {"a": "u", "b": "v", **{names[row]: first_order(text) for row, text in DOUBLE_PENDULUM["rate"].items()}}
    start = {"a": "90 deg", "b": "90 deg", "u": "0", "v": "0"}
    first = equations({"start": start, "where": DOUBLE_PENDULUM["where"], "rate": rows}, l=1, g=9.81)
    one, two = (marched(model, Rk4(step=1e-2), 1.0) for model in (second, first))
    assert np.array_equal(one.y, two.y)


def test_only_second_order_rows_pair_positions_with_velocities():
    paired, _ = laid_out(equations({"start": {"a": "1", "a'": "0", "z": "0"}, "rate": {"z": "a", "a''": "-a"}}))
    assert list(paired.partner) == [1, -1, -1]


def test_what_it_conserves_is_conserved():
    model = equations(DOUBLE_PENDULUM, l=1, g=9.81)
    system, ints = laid_out(model)
    march = March(system, Dopri5(tolerance=1e-12).stepper(), 5.0)
    energies = []
    for t in np.linspace(0.0, 5.0, 11):
        y, rate = march.advance(t)
        energies.append(model.read("energy", ModelState(t, y, rate, march.floats, None, ints)))
    assert np.ptp(energies) < 1e-9 * 9.81


def test_each_copy_goes_as_if_it_were_alone():
    four = equations(SPRING, copies=4, k=9)
    together = marched(four, Rk4(step=1e-2), 1.0)
    assert four.read("i", together).tolist() == [0, 1, 2, 3]
    for number, x in enumerate(four.read("x", together)):
        alone = equations({**SPRING, "start": {"x": str(number + 1), "x'": "0"}}, k=9)
        assert alone.read("x", marched(alone, Rk4(step=1e-2), 1.0)) == x
        assert x == pytest.approx((number + 1) * math.cos(3.0), rel=1e-6)


def test_what_it_gives_has_the_shape_it_says():
    outputs = Equations.outputs(DOUBLE_PENDULUM)
    many = Equations.outputs({**DOUBLE_PENDULUM, "copies": {"count": "3", "as": "k"}})
    one, three = equations(DOUBLE_PENDULUM, l=2, g=1), equations(DOUBLE_PENDULUM, copies=3, l=2, g=1)
    alone, side_by_side = marched(one, Rk4(step=1e-2), 0.1), marched(three, Rk4(step=1e-2), 0.1)
    assert set(many) == {*outputs, "k"}
    for name, gives in outputs.items():
        assert np.shape(one.read(name, alone)) == gives.type.shape
        assert np.shape(three.read(name, side_by_side)) == (3, *many[name].type.shape[1:])
    assert np.allclose(np.linalg.norm(three.read("elbow", side_by_side), axis=1), 2.0)


def test_a_rate_may_read_another_part():
    """y' = cos t, where the cosine is another part's: y = sin t."""
    formulas = {"drive.push": bound("cos(t)", ("t",)).expr}
    model = Equations(start={"y": bound("0", ())}, rate={"y": Formula(Link("drive", "push"))})
    system, _ = laid_out(model, formulas)
    y, _ = March(system, Dopri5(tolerance=1e-12).stepper(), 3.0).advance(3.0)
    assert y[0] == pytest.approx(math.sin(3.0), abs=1e-11)


# --- the compiled kernels --------------------------------------------------------------------------------------------

LEAVES = st.sampled_from(["p", "q", "r", "w", "u", "0.7", "2", "t"])
PLAIN = ["({} + {})", "({} - {})", "({} * {})", "({} / (3 + {}^2))", "(sin({}) * cos({}))"]
# Fourth powers are of what is bounded: seven of them in one another would be infinite at the start.
OTHERS = [
    "atan2({}, 2 + {}^2)",
    "exp(-({})^2 - ({})^2)",
    "hypot({}, 1 + sin({})^4)",
    "mix({}, {}, 0.3)",
    "noise([{}, {}])",
]
SMOOTH = st.sampled_from([*PLAIN, *OTHERS])
FORMULAS = st.recursive(LEAVES, lambda inner: st.builds(str.format, SMOOTH, inner, inner), max_leaves=8)


@settings(max_examples=4)
@given(st.lists(FORMULAS, min_size=3, max_size=3), FORMULAS, st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_the_jacobian_is_the_derivative_of_the_rate(rows, helper, y):
    where = {"u": "p*q - r", "w": helper.replace("w", "u")}
    written = {"start": dict.fromkeys("pqr", "0.1"), "where": where, "rate": dict(zip("pqr", rows, strict=True))}
    system = program(equations(written))
    rate, jacobian = rate_kernel(system), jacobian_kernel(system)
    h = 1e-5
    differences = [(called(rate, y + h * d, 3, 0.4) - called(rate, y - h * d, 3, 0.4)) / (2 * h) for d in np.eye(3)]
    exact = np.zeros(9)
    exact[list(jacobian.places)] = called(jacobian, y, len(jacobian.places), 0.4)
    exact = exact.reshape(3, 3)
    assert np.allclose(exact, np.transpose(differences), rtol=1e-6, atol=1e-6 * max(1.0, np.abs(exact).max()))


def test_every_operation_of_a_kernel_is_the_operation_of_the_table():
    from sceneql.quantities.operations import OPERATIONS

    symbols = ("p", "q", "r")
    names, marks = ("add", "sub", "mul", "div", "pow", "lt", "le", "gt", "ge", "eq"), "+ - * / ^ < <= > >= =="
    signs = dict(zip(names, marks.split(" "), strict=True))
    texts = {}
    for op in TEXTS:
        args = symbols[: min(3, OPERATIONS[op].most)]
        if op in signs:
            texts[op] = f"p {signs[op]} q"
        elif op == "neg":
            texts[op] = "-p"
        elif op in ("noise_line", "noise_space"):
            texts[op] = "noise(p)" if op == "noise_line" else "noise([p, q, r])"
        else:
            texts[op] = f"{op}({', '.join(args)})"
    rows = [bound(text, symbols).expr for text in texts.values()]
    states = (*symbols, *(f"s{k}" for k in range(len(rows) - 3)))
    kernel = rate_kernel(RateSystem(states, tuple(rows), {}))
    for point in ((0.3, 0.6, 0.2), (-0.4, 0.4, 0.9), (0.5, 0.5, -0.5), (1.7, -2.2, 0.0), (0.0, 0.0, 0.0)):
        got = called(kernel, [*point, *np.zeros(len(rows) - 3)], len(rows))
        values = {Symbol(name): value for name, value in zip(symbols, point, strict=True)}
        for op, row, value in zip(texts, rows, got, strict=True):
            assert value == pytest.approx(evaluate(row, values), rel=1e-14, nan_ok=True), (op, point)


def test_the_code_has_neither_the_text_nor_the_numbers_of_the_script():
    written = {
        "start": {"zebra": "1", "yak": "2"},
        "where": {"gnu": "sin(zebra)*7.125"},
        "rate": {"zebra": "gnu*yak^2 - 0.375*t", "yak": "where(zebra > 41, max(yak, 3, zebra), -gnu)"},
    }
    system = program(equations(written))
    for kernel in (rate_kernel(system), jacobian_kernel(system)):
        text = source(kernel)
        assert not any(word in text for word in ("zebra", "yak", "gnu", "7.125"))
        constants = [node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant)]
        assert all(type(value) is int for value in constants)


def test_a_changed_number_compiles_nothing():
    marched(equations(SPRING, copies=2, k=4), Rk4(step=1e-2), 0.1)
    before = kernels.compiled.count
    for k, copies in ((1, 3), (2, 50), (0, 1), (-1, 2)):
        marched(equations(SPRING, copies=copies, k=k), Rk4(step=1e-2), 0.1)
    assert kernels.compiled.count == before


def test_equal_numbers_in_two_places_stay_two_numbers():
    written = {"start": {"x": "1", "y": "1"}, "rate": {"x": "-a*x", "y": "-b*y"}}
    same, different = (rate_kernel(program(equations(written, a=2, b=b))) for b in (2, 3))
    assert same.name == different.name
    assert same.constants != different.constants


# --- what is wrong -------------------------------------------------------------------------------------------------

WRONG = {
    "rate without a start": ({"start": {}, "rate": {"y": "y"}}, ("rate", "y"), "y has a rate but no value at the st"),
    "no start of a'": ({"start": {"a": "1"}, "rate": {"a''": "-a"}}, ("rate", "a''"), "a' has a rate but no value"),
    "start without a rate": (
        {"start": {"y": "1", "yy": "2"}, "rate": {"y": "y"}}, ("start", "yy"), "no rate: did you mean 'y'?"
    ),
    "both orders": (
        {"start": {"a": "1", "a'": "0"}, "rate": {"a": "a", "a''": "-a"}}, ("rate", "a''"), "first and of second order"
    ),
    "a' as a row": ({"start": {"a": "1"}, "rate": {"a'": "a"}}, ("rate", "a'"), "the rate of a is written 'a'"),
    "third order": ({"start": {"a": "1"}, "rate": {"a'''": "a"}}, ("rate", "a'''"), "of order 3"),
    "nothing": ({"start": {}, "rate": {}}, ("rate",), "a system needs a rate"),
    "a state named as a helper": (
        {"start": {"y": "1"}, "rate": {"y": "1"}, "where": {"y": "2"}}, ("where", "y"), "the name of a state already"
    ),
    "a helper named as the time": (
        {"start": {"y": "1"}, "rate": {"y": "1"}, "where": {"t": "2"}}, ("where", "t"), "the name of the time already"
    ),
    "a circle": (
        {"start": {"y": "1"}, "rate": {"y": "u"}, "where": {"u": "v", "v": "u + 1"}}, ("where",), "defined by itself: "
    ),
    "a state in a start": (
        {"start": {"y": "1", "z": "y"}, "rate": {"y": "1", "z": "1"}}, ("start", "z"), "'y' has no value before"
    ),
    "a vector as a rate": ({"start": {"y": "1"}, "rate": {"y": "[y, 1, 2]"}}, ("rate", "y"), "must be one number"),
    "a pole at the start": (
        {"start": {"y": "0"}, "rate": {"y": "1/y"}}, ("rate", "y"), "the rate of y has no finite value at the start"
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_system_is_refused_at_its_row(case):
    written, place, message = WRONG[case]
    with pytest.raises(ValidationError) as caught:
        equations(written)
    errors = caught.value.errors()
    assert any(error["loc"][: len(place)] == place and message in error["msg"] for error in errors), errors


def test_a_pole_in_a_later_copy_is_refused_before_the_run():
    with pytest.raises(ScriptError, match="the rate of y of copy 3 has no finite value at the start") as caught:
        laid_out(equations({"start": {"y": "i - 3"}, "rate": {"y": "1/y"}}, copies=5))
    assert caught.value.diagnostics[0].span.text == "1/y"


def test_errors_point_into_the_script(tmp_path):
    lines = ["sceneql: 1", "models:", "  m:", "    equations:", "      start: {y: 1}", "      rate:"]
    lines += ["        y: z + k", "        w: y"]
    (tmp_path / "scene.yaml").write_text("\n".join(lines))
    with pytest.raises(ScriptError) as caught:
        pipeline.load(tmp_path / "scene.yaml")
    assert [(d.code, d.span.line) for d in caught.value.diagnostics] == [("unknown-name", 7), ("unknown-name", 7)]
    lines[6] = "        y: y"
    (tmp_path / "scene.yaml").write_text("\n".join(lines))
    with pytest.raises(ScriptError, match="w has a rate but no value at the start") as caught:
        pipeline.load(tmp_path / "scene.yaml")
    assert caught.value.diagnostics[0].span.line == 8


@pytest.mark.parametrize("order", ["pq", "qp"])
@pytest.mark.parametrize("solver", ["auto", "{rk4: {step: 1 ms}}", "{radau: {}}"])
def test_equations_read_masses_and_forces_read_equations(tmp_path, order, solver):
    models = {
        "p": "p: {particles: {list: {a: {position: 1 0 0 m}}}}",
        "q": "q: {equations: {start: {y: 0}, rate: {y: p.a.position.x}}}",
    }
    script = f"""
clock: {{end: 2 s}}
models:
  {models[order[0]]}
  {models[order[1]]}
forces: [{{force: {{components: "[-x - 0.3*q.y, 0, 0]"}}}}]
solvers: {{main: {solver}}}
"""
    ((x, y),) = watch(tmp_path, script, [2], "p.a.position", "q.y")
    # x''' = -x' - 0.3 x for y' = x.
    roots = np.roots([1, 0, 1, 0.3])
    parts = np.linalg.solve(np.array([roots**0, roots, roots**2]), [1, 0, -1])
    assert x[0] == pytest.approx((parts * np.exp(2 * roots)).sum().real, abs=1e-5)
    assert y == pytest.approx((parts / roots * (np.exp(2 * roots) - 1)).sum().real, abs=1e-5)
