"""What the pages say holds: rooms and paths are there, and the words that ARCHITECTURE.md adds keep their laws."""

from __future__ import annotations

import ast
import importlib
import math
import re
import shutil
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import runs
import test_conformance_words as conformance
import test_forces_laws as forces
import test_solvers as solvers
from sceneql import pipeline
from sceneql.compiler.catalogue import USER_PACKAGE, Catalogue, class_name

ROOT = Path(__file__).parent.parent
ARCHITECTURE = ROOT / "ARCHITECTURE.md"
CONTRIBUTING = ROOT / "CONTRIBUTING.md"
PAGES = sorted(ROOT.glob("*.md"))
FILE = re.compile(r"^# DIR/(\S+\.py)")
NAMED = re.compile(r"(?<![\w/<>.~-])(?:[a-z_]{3,}/)*(?:[a-z_]{3,}/|[A-Za-z]\w*\.(?:py|md|yaml)\b)")


def rooms():
    """The packages by the names that the table has for them, with the first sentence of what each says of itself."""
    found = {}
    for package in ("sceneql", "renderers"):
        for path in (ROOT / package).rglob("__init__.py"):
            parts = path.parent.relative_to(ROOT).parts[package == "sceneql" :]
            if parts and not (parts[0] == "words" and len(parts) > 1):  # those are the families
                found["/".join(parts[-2:])] = ast.get_docstring(ast.parse(path.read_text())).split("\n\n")[0]
    return found


def test_the_table_of_rooms_is_what_they_say_of_themselves():
    rows = [line.strip("| ").split(" | ") for line in ARCHITECTURE.read_text().splitlines() if line.startswith("| ")]
    cells = [cell for row in rows[1:] for cell in row]
    assert dict(zip(cells[::2], cells[1::2], strict=True)) == rooms()


def test_a_room_says_what_stands_there_in_one_short_sentence():
    for room, sentence in rooms().items():
        assert re.fullmatch(r"[A-Z`].*\.", sentence), room
        assert len(sentence) <= 118, room


def test_the_rooms_stand_in_the_order_of_the_layers():
    layers = (ROOT / "pyproject.toml").read_text().partition("\nlayers = [")[2].partition("\n]")[0]
    linted = dict.fromkeys(re.findall(r"sceneql\.(\w+)", layers))
    left = re.findall(r"^\| (\w+) \|", ARCHITECTURE.read_text(), re.MULTILINE)[1:]
    assert [room for room in linted if room in left] == [room for room in left if room != "renderers"]


def test_the_map_is_one_page():
    lines = ARCHITECTURE.read_text().splitlines()
    assert len(lines) <= 120
    assert max(map(len, lines)) <= 120


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_file_and_folder_that_a_page_names_is_there(page):
    """In code, of this repository: Python files, pages, scripts, and folders of at least three letters."""
    text = page.read_text()
    code = re.findall(r"`([^`\n]+)`|\]\(([^)]+)\)|^    (.*)", text, re.MULTILINE)
    named = [name for parts in code for name in NAMED.findall("".join(parts))]
    missing = [
        name for name in named if not any((ROOT / base / name).exists() for base in ("", "sceneql", "tests/bench"))
    ]
    assert not missing


def test_every_bench_is_in_the_index_and_every_variable_in_the_table():
    page = CONTRIBUTING.read_text()
    benches = {path.name for path in (ROOT / "tests" / "bench").glob("bench_*.py")}
    assert set(re.findall(r"^\| `(bench_\w+\.py)` \|", page, re.MULTILINE)) == benches
    read = (path.read_text() for folder in ("sceneql", "renderers") for path in (ROOT / folder).rglob("*.py"))
    variables = {name for text in read for name in re.findall(r"environ\S*\W(SCENEQL_[A-Z]+)", text)}
    assert variables
    assert all(f"`{name}" in page for name in variables)


def added():
    """The files that ARCHITECTURE.md adds, by their path in a folder of words."""
    (block,) = re.findall(r"```python\n(.*?)```", ARCHITECTURE.read_text(), re.DOTALL)
    files = {}
    for line in block.splitlines(keepends=True):
        if named := FILE.match(line):
            files[named[1]] = ""
        files[named[1] if named else list(files)[-1]] += line
    return files


WORDS = [tuple(path.removesuffix(".py").split("/")) for path in added() if not path.endswith("_kernels.py")]
SHOWN = ROOT / "tests" / "words"
"""The object and the output to start from, which the page names; tests/test_outputs_of_shapes.py runs them."""


@pytest.fixture
def words(tmp_path_factory, monkeypatch):
    """The folder of these words, which scripts of this test may use."""
    folder = tmp_path_factory.mktemp("words")
    shutil.copytree(SHOWN, folder, dirs_exist_ok=True)
    for path, text in added().items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_text(text)
    load = partial(pipeline.load, words=folder)
    for user in (pipeline, runs, forces):
        monkeypatch.setattr(user, "load", load)
    monkeypatch.setattr(conformance, "CATALOGUE", Catalogue(folder))
    return folder


def word(family, name):
    """The class of a word of the folder."""
    return getattr(importlib.import_module(f"{USER_PACKAGE}.{family}.{name}"), class_name(name))


def test_a_solver_a_force_and_a_model_are_added():
    assert sorted(family for family, _ in WORDS) == ["forces", "models", "solvers"]


@pytest.mark.parametrize(("family", "name"), [*WORDS, ("objects", "pyramid"), ("outputs", "ply")])
def test_an_added_word_conforms(words, tmp_path, family, name):
    conformance.test_the_class_is_of_its_family_and_named_as_its_file(family, name)
    conformance.test_it_is_documented_and_so_is_every_field_and_output(family, name)
    conformance.test_a_script_may_write_every_default(family, name, tmp_path)
    conformance.test_no_field_hides_what_its_family_asks_for(family, name)
    conformance.test_its_manual_tells_all(family, name)


TRAP = "{trap: {center: 0.1 0.2 0 m, stiffness: 3 N/m}}"


def test_the_added_force_keeps_the_laws_of_forces(words, tmp_path, monkeypatch):
    monkeypatch.setitem(forces.FORCES, "trap", TRAP)
    forces.test_energy_is_conserved_once_the_work_is_counted(tmp_path, "trap")
    forces.test_it_is_told_apart_from_no_force(tmp_path, "trap")
    forces.test_the_derivatives_are_those_of_the_rate(tmp_path, "trap")


def test_the_added_force_is_what_its_potential_falls_by(words, tmp_path):
    """F = -d(potential)/dx, by central differences of a mass's place, exact where the potential is quadratic."""
    script = """
clock: {end: 1 s}
models: {gas: {particles: {list: {a: {mass: 2 kg, position: [0.5 m, -0.2 m, PLACE]}}}}}
forces: {it: FORCE}
solvers: {main: {rk4: {step: 0.1 s}}}
""".replace("FORCE", TRAP)
    told = [
        runs.watch(tmp_path, script.replace("PLACE", f"{z} m"), [0], "gas.potential", "gas.a.acceleration")[0]
        for z in (0.3, 0.4, 0.5)
    ]
    assert 2 * told[1][1][2] == pytest.approx(-(told[2][0] - told[0][0]) / 0.2, rel=1e-12)


def test_the_added_model_swings_in_the_added_force_as_it_must(words, tmp_path):
    """From rest in a harmonic force x goes as cos(sqrt(stiffness/mass) t), whatever the place."""
    script = """
clock: {end: 2 s}
models: {ring: {ring: {count: 5, mass: 0.5 kg, radius: 0.4 m}}}
forces: {it: {trap: {stiffness: 8 N/m}}}
solvers: {main: {dopri5: {tolerance: 1e-12}}}
outputs: {data: {record: {of: [ring.positions]}}}
"""
    (first, energy), (last, later) = runs.watch(tmp_path, script, [0, 1.7], "ring.positions", "ring.energy")
    assert [energy, later] == pytest.approx([0.5 * 8 * 5 * 0.4**2] * 2, rel=1e-9)
    np.testing.assert_allclose(np.linalg.norm(first, axis=1), 0.4, rtol=1e-15)
    np.testing.assert_allclose(last, first * math.cos(4 * 1.7), rtol=0, atol=1e-10)


def test_slopes_of_the_added_force_let_implicit_solvers_take_large_islands(words, tmp_path):
    script = """
clock: {end: 1 s}
models: {ring: {ring: {count: 100, mass: 0.5 kg}}}
forces: {it: {trap: {stiffness: 8 N/m}}}
solvers: {main: {implicit_midpoint: {step: STEP}}}
outputs: {data: {record: {of: [ring.positions]}}}
"""
    errors = []
    for step in ("10 ms", "5 ms"):
        (first,), (last,) = runs.watch(tmp_path, script.replace("STEP", step), [0, 1], "ring.positions")
        errors.append(np.abs(last - first * math.cos(4)).max())
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.01)


def test_the_added_solver_keeps_the_laws_of_solvers(words, monkeypatch):
    monkeypatch.setattr(solvers, "solver", lambda name: word("solvers", name)())
    for problem in solvers.PROBLEMS:
        solvers.test_its_order_is_the_one_it_claims("ralston", problem)
    solvers.test_impacts_are_found_where_its_own_flight_has_them("ralston")
    for re_, im in ((-1.0, 0.0), (-0.3, 1.0), (0.0, 1.0), (-2.0, 2.0)):
        solvers.test_growth_is_what_a_step_does_to_the_linear_equation("ralston", re_, im)
    for square, damping in ((1e4, 0.0), (1e4, 20.0), (1e4, 400.0), (0.0, 50.0)):
        solvers.test_the_bound_parts_stable_from_unstable_steps("ralston", square, damping)
    solvers.test_dense_output_has_the_order_that_its_ends_or_its_own_formula_allow("ralston")
    solvers.test_frames_change_nothing("ralston")
