"""What every solver word chooses: methods whose compiled functions are there, for masses and for fields on grids."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from importlib.util import find_spec

import numpy as np
import pytest

from sceneql.compiled.generated import load
from sceneql.grids.grid_or_general import MOST_CARRIED
from sceneql.grids.prepare_stages import KERNELS
from sceneql.island.jacobian import BY_DIFFERENCES
from sceneql.kinds import Methods, Solver
from sceneql.march.march import March
from sceneql.stepping.tableau import Tableau
from sceneql.system import Cells, Control, Fields, Grid, IslandFacts, Stepper
from sceneql.words.solvers.auto import Auto
from sceneql.words.solvers.bdf2 import Bdf2
from sceneql.words.solvers.implicit_euler import ImplicitEuler
from sceneql.words.solvers.tr_bdf2 import TrBdf2
from solver_words import EVERY, solver


def plate(cells: int = 32, *, carried: bool = False) -> IslandFacts:
    """An island that is one field on a square whose coefficients vary."""
    n = cells * cells
    square = Cells((cells, cells, 1), (False,) * 3, np.zeros(n, dtype=bool), 0, 0)
    grid = Grid(square, 0, 0, n, (2 * n, 3 * n, 3 * n), varying=True, fed_at=-1, carried=carried)
    return IslandFacts(n + 1, fields=Fields((grid,), alone=True), floats=lambda: np.ones(4 * n))


FACTS = {
    "few masses": IslandFacts(12),
    "few masses that touch": IslandFacts(12, local_contacts=True),
    "many masses": IslandFacts(60_000),
    "many masses that touch": IslandFacts(60_000, local_contacts=True),
    "a field": plate(),
    "a field that drifts": plate(carried=True),
}


def steppers(methods: Methods) -> list[Stepper]:
    return [one for one in (methods.first, methods.stiff, methods.otherwise) if one is not None]


def named(stepper: Stepper) -> Iterator[str]:
    """All functions and classes that it names."""
    method, needs = stepper.method, stepper.needs
    yield from filter(None, (method.step, method.dense, method.extend, needs.prepare, needs.likely, needs.march))


@pytest.mark.parametrize("word", EVERY)
@pytest.mark.parametrize("island", FACTS)
def test_what_a_word_chooses_is_there(word, island):
    methods = solver(word).choose(FACTS[island])
    for stepper in steppers(methods):
        assert stepper.method.step or stepper.needs.march
        for name in named(stepper):
            module, _, attribute = name.partition(":")
            assert callable(getattr(load(module), attribute))
        assert all(find_spec(module) is not None for module in stepper.needs.beside)
        if stepper.needs.march is not None:
            module, _, attribute = stepper.needs.march.partition(":")
            assert issubclass(getattr(load(module), attribute), March)
    assert methods.solver.growth(np.array([[-1.0]]), np.array([-1]), 1e-3) <= 1.0 + 1e-12


@pytest.mark.parametrize("word", EVERY)
def test_what_may_take_over_has_what_it_takes(word):
    for island in FACTS.values():
        methods = solver(word).choose(island)
        if methods.stiff is not None:  # the march compares their steps by the stability function of the first
            assert methods.first.method.stability
            for stepper in (methods.first, methods.stiff):
                assert stepper.control.adaptive
                assert stepper.method.name
        if methods.otherwise is not None:
            assert not methods.first.control.adaptive
            assert methods.remark


@pytest.mark.parametrize("word", EVERY)
def test_methods_are_told_apart_by_what_they_do(word):
    once, again = (solver(word).choose(IslandFacts()) for _ in range(2))
    assert once == again
    other = dataclasses.replace(once, first=dataclasses.replace(once.first, control=Control(first_step=0.125)))
    assert once != other


def test_a_word_that_says_no_more_chooses_its_own_step():
    class Ralston(Solver):
        def stepper(self):
            return Tableau(a=((), (2 / 3,)), b=(1 / 4, 3 / 4)).fixed(1e-3)

    own = Ralston()
    for island in FACTS.values():
        methods = own.choose(island)
        assert methods.solver is own
        assert methods == Methods(own, own.stepper())


def test_auto_takes_radau_along_but_for_few_masses_that_touch():
    bound = BY_DIFFERENCES
    for entries, touching, both in ((bound, False, True), (bound, True, False), (bound + 1, True, True)):
        methods = Auto().choose(IslandFacts(entries, local_contacts=touching))
        assert (methods.stiff is not None) == both


@pytest.mark.parametrize(
    ("tolerance", "impacts", "name", "taken"),
    [
        (1e-3, False, "dopri5", 1e-3),
        (1e-4, False, "dop853", 1e-5),
        (1e-6, False, "dop853", 1e-7),
        (1e-9, False, "dop853", 1e-9),
        (1e-6, True, "dopri5", 1e-6),
        (1e-7, True, "dop853", 1e-7),
    ],
)
def test_auto_takes_its_order_by_the_tolerance_and_by_what_acts_between_steps(tolerance, impacts, name, taken):
    first = Auto(tolerance=tolerance).choose(IslandFacts(12, impacts=impacts)).first
    assert first.method.name == name
    assert first.control.tolerance == pytest.approx(taken)


def test_auto_marches_a_field_by_another_word():
    assert type(Auto().choose(plate()).solver) is TrBdf2


@pytest.mark.parametrize("unknowns", [300, 60_000])
def test_auto_marches_elastic_solids_explicitly_or_by_tr_bdf2_with_a_larger_tolerance(unknowns):
    methods = Auto().choose(IslandFacts(2 * unknowns, in_solids=unknowns, solids_size=0.02))
    assert (methods.first.method.name, methods.stiff.method.name) == ("dop853", "tr_bdf2")
    assert (methods.first.control.tolerance, methods.stiff.control.tolerance) == (1e-5, 1e-4)
    assert methods.stiff.control.absolute == pytest.approx(2e-6)  # of a solid of 2 cm
    assert methods.stiff_cost < 10.0


def test_auto_keeps_radau_for_elastic_solids_at_small_tolerances():
    assert Auto(tolerance=1e-8).choose(IslandFacts(600, in_solids=300)).stiff.method.name == "radau"
    assert type(Auto(tolerance=1e-8).choose(IslandFacts(60_000, in_solids=30_000)).solver) is Bdf2


def test_a_drift_has_the_general_way_at_hand():
    """Fixed steps begin by the grid, those of a tolerance do without; a named solver and large grids have no other."""
    fixed, by_error = ImplicitEuler(), TrBdf2()
    still, drifting = plate(), plate(carried=True)
    assert fixed.choose(still).otherwise is None
    ways = fixed.choose(drifting)
    assert ways.otherwise is not None
    assert ways.otherwise.needs == fixed.stepper().needs
    assert ways.first == fixed.choose(still).first
    assert by_error.choose(drifting).first == by_error.stepper()
    assert by_error.choose(still).first != by_error.stepper()
    assert ImplicitEuler(linear="multigrid").choose(drifting).otherwise is None
    large = plate(1 + int(MOST_CARRIED[2] ** 0.5), carried=True)
    assert fixed.choose(large).otherwise is None


@pytest.mark.parametrize("linear", KERNELS)
def test_the_linear_solver_that_is_named_is_compiled_beside(linear):
    facts = plate()
    grid = dataclasses.replace(facts.fields.grids[0], varying=False)
    still = IslandFacts(facts.entries, fields=Fields((grid,), alone=True))
    beside = ImplicitEuler(linear=linear).choose(still).first.needs.beside
    assert beside[-1] == KERNELS[linear].partition(":")[0]
    assert all(find_spec(module) is not None for module in beside)


def test_auto_takes_a_tolerance_that_is_written_at_its_word_beside_a_barrier():
    apart = IslandFacts(600, apart=True)
    steps = Auto().choose(apart)
    assert type(steps.solver) is TrBdf2
    assert (steps.first.control.adaptive, steps.first.control.first_step) == (False, 1 / 480)
    chosen = Auto(tolerance=1e-5).choose(apart).first.control
    assert (chosen.adaptive, chosen.tolerance) == (True, 1e-5)


@pytest.mark.parametrize("facts", [{}, {"apart": True}])
def test_auto_says_why_large_elastic_solids_are_not_marched_by_bdf2(facts):
    large, small = (Auto().choose(IslandFacts(2 * n, in_solids=n, **facts)) for n in (12_000, 1_000))
    assert "bdf2, of one stage a step, would take" in large.remark
    assert "of one stage" not in small.remark
