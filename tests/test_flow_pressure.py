"""Linear solvers of a flow's pressure, by name."""

import numpy as np
import pytest

from flows import Air
from sceneql.flows.schemes import multistep
from sceneql.quantities.diagnostic import ScriptError

STONE = "objects: {stone: {sphere: {position: 0.5 0.45 0 m, radius: 0.2 m}}}\n"
RING = (
    "objects: {a: {sphere: {position: 0.5 0.5 0 m, radius: 0.4 m}}, b: {sphere: {position: 0.5 0.5 0 m, "
    "radius: 0.3 m}}, ring: {difference: {of: [a, b]}}}\n"
)
THROUGH = '{left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}}'
PLACES = {
    "past a stone": {"before": STONE, "around": "[stone]", "boundary": THROUGH},
    "a closed box": {"initial": '{velocity: "[sin(3*x + y), cos(x*y)]"}'},
    "within and around a ring": {"before": RING, "around": "[ring]", "force": '"[sin(5*y), 0]"'},
    "deep": {
        "before": STONE, "around": "[stone]", "size": "1 1 1 m", "cell": "1/8 m",
        "boundary": '{left: {inflow: {velocity: "[1, 0, 0]"}}, right: {outflow: {}}}',
    },
}  # fmt: skip
ITERATE = ("multigrid", "conjugate_gradient", "gauss_seidel", "sor")


def after(folder, place, pressure, solver="{sbdf2: {step: 20 ms}}"):
    return Air(folder, solver, 0.1, pressure=pressure, **PLACES[place]).at(0.1)


@pytest.mark.parametrize("place", PLACES)
def test_every_solver_of_the_pressure_finds_the_same_flow(tmp_path, place):
    """Of one in parts that nothing flows between, too; what they leave falls, to parts in 1e11 of what flows."""
    known = after(tmp_path, place, "auto").read("velocity")
    for name in ("direct", *ITERATE):
        air = after(tmp_path, place, name)
        assert air.read("velocity") == pytest.approx(known, abs=1e-9 * np.abs(known).max()), name
        assert air.read("divergence") < 1e-8 * air.read("largest_speed") * 16, name
        if name in ITERATE:
            left = air.read("residuals")
            assert left[0] > left[-1]
            assert len(left) == 128 or left[-1] < 1e-10 * left[0]


@pytest.mark.parametrize("cells", [(64, 48), (7, 16), (34, 22), (128, 9), (15, 32)])
@pytest.mark.parametrize("boundary", ["{rest: {wall: {}}}", "{left: {periodic: yes}}", "{right: {outflow: {}}}"])
def test_transforms_of_any_length_find_what_factors_do(tmp_path, cells, boundary):
    """By sixteen, four, two, other primes and these together, with waves and cosines, rows in whole lanes and not."""
    size = {"size": f"{cells[0]} {cells[1]} m", "cell": "1 m", "boundary": boundary, "viscosity": "2 Pa*s"}
    start = {"initial": '{velocity: "[sin(0.7*x)*cos(y), sin(x*y)]"}'}
    found = [
        Air(tmp_path, "{sbdf2: {step: 0.2 s}}", 0.4, pressure=name, **size, **start) for name in ("auto", "direct")
    ]
    known = found[1].at(0.4).read("velocity")
    assert found[0].at(0.4).read("velocity") == pytest.approx(known, abs=1e-11)
    assert found[0].read("divergence") < 1e-12


@pytest.mark.parametrize("place", ["past a stone", "within and around a ring"])
def test_iterations_on_cells_near_solids_come_to_what_factors_do(tmp_path, place):
    """There are few of these among 32 by 32; a third and more of all are iterated on as all are."""
    fields = {**PLACES[place], "cell": "1/32 m"}
    found = [Air(tmp_path, "{sbdf2: {step: 10 ms}}", 0.05, pressure=name, **fields) for name in ("auto", "direct")]
    known = found[1].at(0.05).read("velocity")
    assert found[0].at(0.05).read("velocity") == pytest.approx(known, abs=1e-9 * np.abs(known).max())


@pytest.mark.parametrize(
    ("place", "viscosity"), [("0.5 0.45", 0.01), ("0.5 0.085", 0.002)], ids=["free", "on the floor"]
)
@pytest.mark.parametrize("solver", ["{sbdf2: {step: 2 ms}}", "{ark3: {step: 2 ms}}"])
def test_viscosity_about_a_small_solid_comes_to_what_iterations_on_all_cells_do(
    tmp_path, monkeypatch, solver, place, viscosity
):
    """Transforms find it elsewhere: but for rounding and for what either leaves, it is the same flow."""
    stone = STONE.replace("0.2 m", "0.08 m").replace("0.5 0.45", place)
    fields = {
        "cell": "1/64 m",
        "viscosity": f"{viscosity} Pa*s",
        "before": stone,
        "around": "[stone]",
        "boundary": THROUGH,
    }
    near = Air(tmp_path, solver, 0.01, **fields).at(0.01).read("velocity")
    monkeypatch.setattr(multistep, "_odd_rows", lambda odd: [])
    known = Air(tmp_path, solver, 0.01, **fields).at(0.01).read("velocity")
    assert (near != known).any()
    assert near == pytest.approx(known, abs=1e-8 * np.abs(known).max())


def test_solvers_of_the_pressure_differ_in_their_iterations(tmp_path):
    """As on any box: over-relaxed sweeps are fewer than plain ones, cycles over coarser grids by far the fewest."""
    left = {name: after(tmp_path, "a closed box", name).read("residuals") for name in ITERATE}
    assert len(left["multigrid"]) < 15 < len(left["sor"]) < len(left["gauss_seidel"])


def test_a_named_solver_of_the_pressure_serves_the_stages_of_ark3(tmp_path):
    known = after(tmp_path, "past a stone", "auto", "{ark3: {step: 20 ms}}").read("velocity")
    found = after(tmp_path, "past a stone", "multigrid", "{ark3: {step: 20 ms}}").read("velocity")
    assert found == pytest.approx(known, abs=1e-9)


def test_fast_transforms_by_name_are_those_of_auto(tmp_path):
    known = after(tmp_path, "a closed box", "auto").read("velocity")
    assert (after(tmp_path, "a closed box", "fast_transform").read("velocity") == known).all()


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"pressure": "fast_transform", "around": "[stone]", "before": STONE}, "needs a box without solids"),
        (
            {"pressure": "fast_transform", "boundary": '{right: {where: "y - 0.4", outflow: {}}}'},
            "each side of which is a way out as a whole or not at all",
        ),
        ({"pressure": "direct", "cell": "1/300 m"}, "factors of 90,000 cells would not fit"),
    ],
)
def test_what_a_solver_of_the_pressure_cannot_do_is_told_where_it_is_named(tmp_path, fields, text):
    with pytest.raises(ScriptError, match=text):
        Air(tmp_path, **fields)
