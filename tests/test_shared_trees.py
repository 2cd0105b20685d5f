"""What is used twice is one tree: work grows with the lines of a script, not with 2 to the power of their number."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from runs import complaint, watch
from sceneql.compiled.printer import Constants, Printer
from sceneql.field.tape.builder import TapeBuilder
from sceneql.pipeline import load
from sceneql.quantities.derivative import differentiate
from sceneql.quantities.expression import Call, Expr, Symbol, Vector, each_once, recursive, walk
from sceneql.run.run import Run

MANY = 60
X = Symbol("x")


def doubled(name: str, count: int = MANY) -> str:
    """Defines of which each has the value of the one before, which it names twice; the last line comes first."""
    return "".join(f"  {name}{k}: ({name}{k - 1} + {name}{k - 1})/2\n" for k in range(count, 0, -1))


def squared(count: int = MANY) -> Expr:
    """x squared again and again."""
    expr: Expr = X
    for _ in range(count):
        expr = Call("mul", (expr, expr))
    return expr


def test_equal_trees_are_equal_however_often_their_parts_are_used() -> None:
    one, other = squared(3000), squared(3000)
    assert one == other
    assert hash(one) == hash(other)
    assert one != squared(2999)
    assert Vector((one,)) == Vector((other,)) != Vector((X,))


def test_walking_meets_each_node_once_before_those_below_it() -> None:
    shared = Call("sin", (X,))
    first = Call("cos", (shared,))
    assert list(walk(Call("add", (first, shared)))) == [Call("add", (first, shared)), first, shared, X]


def test_a_recursive_function_goes_as_deep_as_the_tree() -> None:
    expr: Expr = X
    for _ in range(5000):
        expr = Call("neg", (expr,))
    counted = []

    def depth(node: Expr):  # type: ignore[no-untyped-def]
        counted.append(node)
        return 1 + (yield node.args[0]) if isinstance(node, Call) else 0

    assert recursive(depth, expr) == 5000
    assert len(counted) == 5001


def test_kernels_tapes_and_derivatives_have_a_line_for_each_shared_part() -> None:
    constants = Constants()
    printer = Printer({"x": "x"}, {}, constants)
    printer.name(constants.lift(squared()))
    assert len(printer.lines) == MANY
    build = TapeBuilder()
    tape = build.finish(build.expression(squared(), {"x": build.x}))
    assert len(tape.code) == MANY + 1
    assert len(each_once(differentiate(squared(), X))) < 6 * MANY


@pytest.mark.parametrize(
    "part",
    [
        'objects: {b: {sphere: {radius: "0.1 m*a60"}}}',
        'objects: {b: {implicit: {field: "x^2 + y^2 + z^2 - a60"}}}',
        'models: {e: {equations: {start: {y: 1}, rate: {y: "-y*a60"}, invariants: {i: "y + a60"}}}}',
        'overlays: {c: {caption: {text: "{a60:.2f} and {final(a60):.2f}"}}}',
        'expect: {e: {of: "final(a60)", value: 1, tolerance: 1, because: told}}',
        'objects: {b: {sphere: {color: "hue(a60)", position: {keys: {0 s: "[a60*(1 m), 0 m, 0 m]", 1 s: 0 0 0 m}}}}}',
    ],
)
def test_defines_that_name_others_twice_are_checked_at_once(part: str, tmp_path: Path) -> None:
    text = f"define:\n{doubled('a')}  a0: 1 + time/(1 s)\n{part}\noutputs: {{still: {{image: {{}}}}}}\n"
    assert complaint(tmp_path, text) == ""


SPRING = f"""
clock: {{end: 0.1 s}}
define:
{doubled("a")}  a0: 1 + time/(1 s)
{doubled("b")}  b0: pair.m.position.x/(1 m)
models:
  pair: {{mass_spring: {{masses: {{m: {{position: 1 0 0 m}}, n: {{position: 0 1 0 m}}}}}}}}
  decay: {{equations: {{start: {{y: 1}}, rate: {{y: -w60}}, invariants: {{i: i60}}, where: {{
    {doubled("w").replace(chr(10), ",")} w0: y, {doubled("i").replace(chr(10), ",")} i0: a60}}}}}}
forces:
  shove: {{force: {{"on": pair, components: ["-b60*a60*x", "0", "0"]}}}}
  slow: {{drag: {{"on": pair, linear: "1 kg/s*b60*a60"}}}}
solvers: {{implicit: {{radau: {{}}}}}}
outputs: {{numbers: {{record: {{of: [pair.m.position.x, decay.i]}}}}}}
"""


def test_forces_and_equations_whose_parts_are_used_twice_march(tmp_path: Path) -> None:
    outputs = ("pair.m.position", "decay.y", "decay.i")
    plain = re.sub(r"(?<=[abwi])60(?!:)", "0", SPRING)
    (found,), (wanted,) = (watch(tmp_path, text, [0.1], *outputs) for text in (SPRING, plain))
    assert np.hstack(found) == pytest.approx(np.hstack(wanted), rel=1e-12, abs=1e-15)


def test_objects_that_read_one_another_twice_are_drawn(tmp_path: Path) -> None:
    lines = "".join(
        f"  b{k}: {{sphere: {{position: (b{k - 1}.position + b{k - 1}.position)/2}}}}\n" for k in range(1, 50)
    )
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\nobjects:\n  b0: {sphere: {position: [1 m*time/(1 s), 0 m, 0 m]}}\n"
        f"{lines}outputs: {{still: {{image: {{}}}}}}\n"
    )
    (moment,) = Run(load(path)).moments([1.0])
    assert list(moment.read("b49", "position")) == [1.0, 0.0, 0.0]


def test_templates_whose_fields_name_others_twice_are_written_out(tmp_path: Path) -> None:
    inner = "".join(
        f"  t{k}: {{fields: {{x: 1}}, parts: {{i: {{t{k - 1}: {{x: (x + x)/2}}}}}}}}\n" for k in range(1, 41)
    )
    text = (
        "templates:\n  t0: {fields: {x: 1}, objects: {s: {sphere: {radius: x*(0.1 m)}}}}\n"
        f"{inner}parts: {{p: {{t40: {{x: 1 + time/(1 s)}}}}}}\noutputs: {{still: {{image: {{}}}}}}\n"
    )
    assert complaint(tmp_path, text) == ""


def test_defines_and_helper_quantities_may_stand_in_long_rows(tmp_path: Path) -> None:
    rows = ", ".join(f"w{k}: w{k - 1}" for k in range(600, 0, -1))
    text = (
        f"objects: {{b: {{sphere: {{radius: 0.1 m*a2000}}}}}}\ndefine:\n{doubled('a', 2000)}  a0: 1 + time/(1 s)\n"
        f"models: {{e: {{equations: {{start: {{y: 1}}, rate: {{y: -w600}}, where: {{{rows}, w0: y}}}}}}}}\n"
        "outputs: {still: {image: {}}}\n"
    )
    assert complaint(tmp_path, text) == ""


def test_a_long_circle_of_defines_is_told_once(tmp_path: Path) -> None:
    said = complaint(tmp_path, f"define:\n{doubled('a', 500)}  a0: a500\n")
    assert said.count("error[") == 1
    assert "defined by itself, over more than 40 others" in said


def test_lists_that_hold_one_another_twice_end_at_a_limit(tmp_path: Path) -> None:
    lines = "".join(f"  a{k}: '[a{k - 1}, a{k - 1}]'\n" for k in range(40, 0, -1))
    said = complaint(tmp_path, f"define:\n{lines}  a0: 1\n")
    assert said.count("error[") == 1
    assert "a list has at most 6 axes and 1000000 numbers, not 7 and 128" in said
