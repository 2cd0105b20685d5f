"""What `bench` promises: true errors, the observed order, failures listed, a table and a plot."""

from __future__ import annotations

import csv
import json
import math
import re
import xml.etree.ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from campaigns import LONG
from sceneql import pipeline
from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import Unsuitable
from sceneql.report import plots, work_precision
from sceneql.report.bench import bench, cheapest
from sceneql.report.curve_ends import GAP, band, label_ends, repeats, spread
from sceneql.report.order import observed_order
from sceneql.report.page import Table, write_page
from sceneql.report.work_precision import Measurement

SPRING = """\
sceneql: 1
define: {k: 4}
clock: {end: 2 s}
models:
  spring:
    equations:
      start: {x: 1, x': 0}
      rate: {x'': -k*x}
solvers: {main: {rk4: {step: 1 ms}}}
outputs: {table: {record: {of: [spring.x]}}}
"""
EXACT = """\
expect:
  x: {of: final(spring.x), value: cos(2*sqrt(k)), because: "exact, x = cos(sqrt(k) t)"}
"""
VELOCITY = """\
  v: {of: "final(spring.x')", value: -sqrt(k)*sin(2*sqrt(k)), because: exact}
"""
HALF = """\
expect:
  length: {of: "final(abs(spring.x))", value: abs(cos(4)), because: conserved}
"""


@pytest.fixture
def quick(monkeypatch):
    """Fewer runs."""
    monkeypatch.setattr(work_precision, "STEPS", tuple(2**k for k in range(4, 12)))
    monkeypatch.setattr(work_precision, "TOLERANCES", tuple(10.0**-k for k in range(3, 13)))
    monkeypatch.setattr(work_precision, "REPEATS", 1)


@pytest.fixture
def few(monkeypatch):
    """Fewer solvers: each is compiled for each structure of an island. No other family is asked for."""
    words = Catalogue.words
    kept = {"dopri5", "euler", "midpoint", "radau", "rk4", "semi_implicit_euler"}
    monkeypatch.setattr(Catalogue, "words", lambda self, family: [w for w in words(self, family) if w in kept])


@pytest.fixture
def undrawn(monkeypatch):
    """Figures are made and their files written, but nothing is drawn: other tests look at what is."""
    monkeypatch.setattr(Figure, "savefig", lambda self, file, **options: file.write(b"<svg/>"))


def measured(tmp_path, script, *sets):
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    text = bench(pipeline.load(path, sets=sets), tmp_path)
    with (tmp_path / "scene.bench.csv").open(newline="") as file:
        return text, list(csv.DictReader(file))


def test_the_observed_orders_are_the_methods_orders(tmp_path, quick, undrawn, request):
    if not LONG:  # the orders of all: test_solvers.py and test_implicit_solvers.py
        request.getfixturevalue("few")
    text, rows = measured(tmp_path, SPRING + EXACT)
    orders = {row["solver"]: float(row["order"]) for row in rows if row["order"]}
    known = {"euler": 1, "semi_implicit_euler": 1, "midpoint": 2, "rk4": 4}
    assert {name: orders[name] for name in known} == pytest.approx(known, abs=0.1)
    assert orders["dopri5"] == pytest.approx(5, abs=0.25)
    assert "against exact: x" in text
    for solver in orders:
        errors = [float(row["error"]) for row in rows if row["solver"] == solver]
        assert errors == sorted(errors, reverse=True)
    assert all(float(row["seconds"]) > 0 and int(row["steps"]) > 0 for row in rows)
    fixed = [row for row in rows if row["adaptive"] == "False"]
    assert all(float(row["setting"]) * int(row["steps"]) == pytest.approx(2.0) for row in fixed)
    rk4 = [row for row in fixed if row["solver"] == "rk4"]
    assert all(4 * int(row["steps"]) <= int(row["evaluations"]) <= 4 * int(row["steps"]) + 2 for row in rk4)


def test_without_a_solution_the_reference_is_another_methods(tmp_path, quick, few, undrawn):
    text, rows = measured(tmp_path, SPRING)
    assert "against scipy's DOP853" in text
    by_step = {(row["solver"], row["setting"]): float(row["error"]) for row in rows}
    _, exact = measured(tmp_path, SPRING + EXACT + '  v: {of: "final(spring.x\')", value: -2*sin(4), because: exact}\n')
    common = [row for row in exact if (row["solver"], row["setting"]) in by_step]
    assert len(common) > 0.9 * len(exact)  # the finest runs depend on how good the reference is
    for row in common:
        found = by_step[row["solver"], row["setting"]]
        assert found == pytest.approx(float(row["error"]), rel=0.02, abs=1e-12)


def test_a_number_that_is_not_exact_is_no_solution(tmp_path, quick, few, undrawn):
    text, _ = measured(tmp_path, SPRING + HALF)
    assert "against scipy's DOP853" in text


def test_failed_runs_are_listed_as_failed(tmp_path, quick, few, undrawn):
    text, rows = measured(tmp_path, SPRING, "define.k=1e4")
    failed = [row for row in rows if row["outcome"] != "ok"]
    assert {"rk4", "midpoint"} <= {row["solver"] for row in failed}
    assert all(math.isnan(float(row["error"])) and "unstable" in row["outcome"] for row in failed)
    assert all(float(row["setting"]) * 1e2 > 2.8 for row in failed if row["solver"] == "rk4")
    assert "failed at" in text


def test_the_plot_names_solvers_and_orders(tmp_path, quick, few):
    measured(tmp_path, SPRING + EXACT)
    tree = ET.parse(tmp_path / "scene.bench.svg")
    texts = {"".join(node.itertext()).strip() for node in tree.iter("{http://www.w3.org/2000/svg}text")}
    assert {"rk4, order 4.0", "euler, order 1.0", "run time [s]", "relative error at the end"} <= texts


def test_a_scene_without_physics_has_nothing_to_measure(tmp_path):
    (tmp_path / "still.yaml").write_text("sceneql: 1\nobjects: {ball: sphere}\noutputs: {picture: {image: {}}}\n")
    with pytest.raises(ValueError, match="nothing to measure"):
        bench(pipeline.load(tmp_path / "still.yaml"), tmp_path)


def runs(solver, *pairs):
    return [Measurement("spring", solver, False, 1e-3, "ok", error, seconds, 1, 1) for error, seconds in pairs]


@given(st.floats(1e-9, 1e-1))
def test_the_cheapest_solver_is_the_one_whose_curve_lies_lowest_at_the_error(asked):
    """Two power laws that cross at 1e-4."""
    first = runs("first", *((1e-10 * 10.0**k, 1e-2 * 10.0**-k) for k in range(11)))
    fourth = runs("fourth", *((1e-10 * 10.0**k, 1e-6 * 10 ** (1.5 - 0.25 * k)) for k in range(11)))
    word, seconds = cheapest([*first, *fourth], asked)
    laws = {"first": 1e-12 / asked, "fourth": 1e-6 * 10**-1.0 * asked**-0.25}
    assert seconds == pytest.approx(min(laws.values()), rel=1e-6)
    assert laws[word] == pytest.approx(seconds, rel=1e-6)


def test_no_solver_is_the_cheapest_for_an_error_that_none_reaches():
    assert cheapest(runs("euler", (1e-1, 1.0), (1e-2, 10.0)), 1e-3) is None
    assert cheapest(runs("euler", (1e-1, 1.0), (1e-2, 10.0)), 0.5) == ("euler", 1.0)


PENDULUM = """\
sceneql: 1
clock: {end: 2 s}
models:
  swing:
    mass_spring:
      masses: {pivot: {fixed: yes}, bob: {position: 1 0 0 m}}
      springs: [{between: [pivot, bob]}]
objects: {ground: {plane: {position: 0 -1.2 0 m}}}
forces: [gravity, FLOOR]
solvers: {main: {rk4: {step: 4 ms}}}
outputs: {table: {record: {of: [swing.energy]}}}
"""


@pytest.mark.parametrize("floor", ["", "{collision: {restitution: 0.7}}"])
def test_masses_are_benched_with_their_drift_and_a_page_with_and_without_contacts(tmp_path, quick, few, undrawn, floor):
    script = PENDULUM.replace(", FLOOR", f", {floor}" if floor else "")
    graph = pipeline.load(written(tmp_path, script))
    text = bench(graph, tmp_path, asked=1e-3)
    assert "cheapest for an error of 1e-03:" in text
    found = json.loads((tmp_path / "scene.bench.json").read_text())
    drifts = {one["solver"]: max(map(abs, one["changes"])) for one in found["drifts"]}
    assert drifts["rk4"] < 1e-4 < drifts["euler"]
    assert {row["solver"] for row in found["runs"]} == set(drifts) >= {"dopri5", "midpoint", "semi_implicit_euler"}
    best = min(row["error"] for row in found["runs"] if row["solver"] == "dopri5")
    assert best < 1e-6
    page = (tmp_path / "scene.bench.html").read_text()
    assert page.count("data:image/svg+xml;base64,") == 3
    assert "Drift of energy" in page
    assert ("contacts" in text) == bool(floor)


def written(tmp_path, script):
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    return path


def test_what_a_page_holds_is_escaped(tmp_path):
    write_page(tmp_path / "page.html", "<b>", ["a & b <script>"], [], [Table("t", ["<th>"], [[("<i>", "stable")]])])
    text = (tmp_path / "page.html").read_text()
    assert "&lt;script&gt;" in text
    assert '<td class="stable">&lt;i&gt;</td>' in text
    assert "<script>" not in text


@given(st.floats(0.5, 8), st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_the_order_of_a_power_law_is_its_exponent(order, scale, step):
    steps = [step * 2.0**-k for k in range(30)]
    errors = [scale * (h / step) ** order for h in steps]
    usable = sum(1e-12 < e < 0.1 for e in errors)
    found = observed_order(steps, errors)
    assert found is None if usable < 4 else found == pytest.approx(order, abs=1e-9)


@given(st.sampled_from([1, 2, 4, 5]), st.floats(0.1, 3))
def test_neither_coarse_steps_nor_rounding_change_the_order(order, bend):
    steps = [2.0**-k for k in range(1, 16)]
    errors = [0.05 * h**order * (1 + bend * h) + 1e-15 for h in steps]
    assert observed_order(steps, errors) == pytest.approx(order, abs=0.15)


@given(st.lists(st.sampled_from([0.5, 8.0]), min_size=5, max_size=9))
def test_errors_that_bend_at_the_smallest_steps_have_no_order(slopes):
    """Slopes that jump between 0.5 and 8 at the three smallest steps are no power law, whatever stands above."""
    exponents = [*slopes, 0.5, 8.0, 0.5, 8.0]
    errors = [0.09]
    for exponent in exponents:
        errors.append(errors[-1] * 2.0**-exponent)
    assert observed_order([2.0**-k for k in range(len(errors))], errors, 0.0) is None


PAIR = """\
clock: {end: 1 s}
models:
  bob:
    mass_spring:
      masses: {a: {position: 0 0 0 m}, b: {position: 1.5 0 0 m, mass: 2 kg}}
      springs: [{between: [a, b], stiffness: 100 N/m, rest: 1 m}]
solvers: {main: {rk4: {step: 1 ms}}}
outputs: {table: {record: {of: [bob.a.position]}}}
"""


def test_chosen_solvers_alone_run_with_drifts_in_a_table_and_labels_at_the_ends_of_curves(tmp_path, quick):
    path = tmp_path / "scene.yaml"
    path.write_text(PAIR)
    text = bench(pipeline.load(path), tmp_path, chosen=("rk4", "semi_implicit_euler"))
    with (tmp_path / "scene.bench.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["solver"] for row in rows} == {"rk4", "semi_implicit_euler"}
    assert all(float(row["seconds"]) <= float(row["median"]) for row in rows if row["outcome"] == "ok")
    assert re.search(r"bob by rk4 at 0.001: energy drifts by \S+ at most, momentum by \d", text)
    page = (tmp_path / "scene.bench.html").read_text()
    table = page.partition("Drifts, relative")[2].partition("</table>")[0]
    assert "momentum at most" in table
    assert re.search(r"<td>bob</td><td>rk4</td><td>0.001</td>(<td>-?\d\.\d\de[-+]\d+</td>){3}", table)
    for name in ("scene.bench", "scene.bench.step", "scene.bench.drift"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert f"{name}.png" in text
    drawn = ET.parse(tmp_path / "scene.bench.svg").getroot()
    assert not drawn.findall(".//*[@id='legend_1']")
    assert any("rk4, order " in (part.text or "") for part in drawn.iter())
    with pytest.raises(Unsuitable, match="there is no solver 'rk5': did you mean 'rk4'"):
        bench(pipeline.load(path), tmp_path, chosen=("rk5",))


def test_labels_move_apart_as_little_as_they_need():
    assert spread([]) == []
    assert spread([0.2, 0.6]) == [0.2, 0.6]
    low, middle, high = spread([0.5, 0.5, 0.51])
    assert (middle - low, high - middle) == pytest.approx((GAP, GAP))
    for heights in ([1.0, 1.0, 1.0], [0.0] * 30, [0.5] * 22):
        found = spread(heights)
        assert found == sorted(found)
        assert found[0] + 1e-12 >= 0.0
        assert found[-1] <= 1.0


def test_a_label_stands_at_the_end_that_is_nearest_to_it():
    """Of curves by run time that is the last point, of those by step the first."""
    axes = Figure().subplots()
    axes.plot([1.0, 2.0, 3.0], [1.0, 0.5, 0.1], label="time")
    axes.plot([3.0, 2.0, 1.0], [2.0, 1.0, math.nan], label="step")
    label_ends(axes)
    assert {text.get_text(): text.xy for text in axes.texts} == {"time": (3.0, 0.1), "step": (3.0, 2.0)}


@pytest.mark.parametrize("draw", [band, repeats])
def test_a_run_that_was_slow_now_and_then_leaves_the_scale_to_the_points(draw):
    from matplotlib.figure import Figure

    axes = Figure().subplots()
    axes.set(xscale="log", yscale="log")
    (line,) = axes.plot([1e-3, 2e-3], [1e-2, 1e-3], label="rk4")
    label_ends(axes)
    before = axes.get_xlim()
    draw(axes, line, [1e-3, 5.0])
    assert axes.get_xlim() == before


def test_ticks_of_a_map_are_plain_numbers():
    assert [plots._tick(value) for value in (0.0316, 12.5, 1000.0, 46700.0)] == ["0.0316", "12.5", "1000", "46700"]
