"""Contacts of few rigid bodies that are exact by themselves, and go on in mode `local` where there is no way on."""

import re

import numpy as np
import pytest

from sceneql.contacts.rigid_exact import exact_rows_kernels
from sceneql.failure import RunFailure
from sceneql.pipeline import load
from sceneql.report.explain import explain, text
from sceneql.run.run import Run

TABLE = "table: {box: {size: 1 0.2 1 m, position: 0 -0.1 0 m}}"
COLUMN = "it: {cylinder: {radius: 0.1 m, height: 0.2 m, position: 0.3 0.1 0 m, rotation: {about: y, angle: 20 deg}}}"


def scene(folder, law, objects=f"{TABLE}, {COLUMN}", motion="velocity: 2 0 0 m/s", more="", solver=""):
    path = folder / "scene.yaml"
    path.write_text(f"""
clock: {{end: 1 s}}
objects: {{{objects}}}
models: {{body: {{rigid: {{of: it, mass: 1 kg, {motion}}}}}}}
forces: [gravity]
contacts: {{touch: {{collision: {{{law}}}}}}}
{solver}
{more}
""")
    return load(path, pruned=False)


def test_what_exact_contacts_cannot_follow_goes_on_in_steps_and_is_told(tmp_path):
    run = Run(scene(tmp_path, "restitution: 0, friction: 0.2"))
    energies, places, modes = [], [], []
    for moment in run.moments(np.linspace(0, 1, 11)):
        energies.append(moment.read("body", "energy"))
        places.append(moment.read("body", "position"))
        modes.append(run.islands[0].assembly.contact_mode)
    assert modes[0] == "exact"
    assert modes[-1] == "local"
    # Samples within a step of mode `local` are of order 1 in it: the energy there is up to 1 % off, with what friction
    # took, and back at the step's end. Where all is at rest there is no such error.
    assert energies[-1] == pytest.approx(energies[0], rel=1e-5)
    np.testing.assert_allclose(energies, energies[0], rtol=1e-2)
    assert places[-1][1] < 0  # it has slid over the edge, and lies below
    steps = np.diff(np.array(places)[:, 0])
    assert steps.max() < 0.2
    (note,) = run.islands[0].notes
    assert re.match(r"at 0\.0\d+ s, touch: contacts go on in mode `local`: ", note.message)


def test_a_run_whose_contacts_are_exact_by_name_stops_there(tmp_path):
    with pytest.raises(RunFailure, match=r"contacts: \{touch"):
        for _ in Run(scene(tmp_path, "restitution: 0, friction: 0.2, mode: exact")).moments([1]):
            pass


def test_impacts_that_were_counted_stay_counted(tmp_path):
    law = "restitution: 0, friction: 0.2"
    run = Run(scene(tmp_path, law, f"{TABLE}, {COLUMN.replace('0.3 0.1 0', '0.3 0.101 0')}"))
    counts = [moment.read("touch", "hits.count") for moment in run.moments([0.03, 1])]
    assert run.islands[0].assembly.contact_mode == "local"
    assert counts[0] >= 1
    assert counts[1] >= counts[0]


def test_contacts_that_take_too_much_work_go_on_in_steps(tmp_path, monkeypatch):
    """What is allowed is a count of operations, which compiled kernels know; here the body begins with more."""
    graph = scene(tmp_path, "restitution: 0", f"{TABLE}, it: {{sphere: {{radius: 0.1 m, position: 0 0.5 0 m}}}}", "")
    run = Run(graph)
    island = run.islands[0]
    memory = island.assembly.ints_of("sceneql.contacts.rigid_exact.exact_hold_kernels:hold")
    at = memory[exact_rows_kernels.MEMORY_AT] + exact_rows_kernels.WORK
    island.march.floats[at] = 2 * exact_rows_kernels.BEFOREHAND
    (moment,) = run.moments([1])
    assert island.assembly.contact_mode == "local"
    (note,) = island.notes
    assert note.message == "at 0 s, touch: contacts go on in mode `local`: contacts take more work than they may"
    np.testing.assert_allclose(moment.read("body", "position"), [0, 0.1, 0], atol=1e-9)


@pytest.mark.parametrize(
    ("law", "more", "solver", "told"),
    [
        ("friction: 0.2", "", "", "exact: chosen for up to 8 rigid bodies; `local` goes on where"),
        ("rolling: 1 mm", "", "", "exact: chosen for up to 8 rigid bodies; `local` goes on where"),
        ("friction: 0", "", "solvers: {main: {rk4: {step: 1 ms}}}", "local: chosen for rigid bodies: `exact` locates"),
        ("friction: 0", "", "solvers: {main: radau}", "local: chosen for rigid bodies: `exact` locates"),
        ("mode: local", "", "", "local: asked for by the script"),
    ],
)
def test_explain_tells_which_mode_and_why(tmp_path, law, more, solver, told):
    assert told in text(explain(scene(tmp_path, law, more=more, solver=solver)))


RING = "it: {torus: {radius: 0.1 m, tube: 0.03 m, position: 0.3 0.03 0 m}}"


@pytest.mark.parametrize(
    ("it", "other", "told"),
    [
        (RING, "torus: {radius: 0.2 m, tube: 0.05 m, position: 0 1 0 m}", "'it' and 'other' are both curved"),
        (
            COLUMN,
            "cylinder: {radius: 0.2 m, height: 0.1 m, position: 0.3 0.25 0 m}",
            "'it' and 'other' touch where one is flat: two curved bodies meet in mode `exact` by",
        ),
    ],
)
def test_two_curved_bodies_have_local_contacts_and_explain_tells_why(tmp_path, it, other, told):
    graph = scene(tmp_path, "friction: 0", f"{TABLE}, {it}, other: {{{other}}}")
    assert f"local: chosen for rigid bodies: {told}" in text(explain(graph))


def test_a_cylinder_that_another_body_strikes_is_exact_by_default_and_makes_no_energy(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("""
objects:
  drum: {cylinder: {radius: 0.3 m, height: 0.4 m, position: 0 0.2 0 m}}
  ball: {sphere: {radius: 0.1 m, position: 0.05 0.8 0 m}}
  floor: {plane: {}}
models: {under: {rigid: {of: drum, mass: 5 kg}}, it: {rigid: {of: ball, mass: 1 kg}}}
forces: [gravity]
contacts: {touch: {collision: {restitution: 0.5, friction: 0.3}}}
clock: {end: 1.5 s}
""")
    run = Run(load(path, pruned=False))
    told = [moment.read("under", "energy") + moment.read("it", "energy") for moment in run.moments([0.0, 0.5, 1.5])]
    assert run.islands[0].assembly.contact_mode == "exact"
    np.testing.assert_allclose(told, told[0], rtol=1e-6)


SEESAW = """
objects:
  wedge: {cylinder: {radius: 0.25 m, height: 0.6 m, position: 0 0.25 0 m, rotation: {about: x, angle: 90 deg}}}
  plank: {box: {size: 3 0.08 0.5 m, position: 0 0.55 0 m}}
  crate: {box: {size: 0.3 0.3 0.3 m, position: -1.3 0.745 0 m}}
  weight: {sphere: {radius: 0.3 m, position: 1.2 2.5 0 m}}
models:
  things:
    rigid:
      bodies:
        plank: {of: plank, density: 300 kg/m^3}
        crate: {of: crate, density: 200 kg/m^3}
        weight: {of: weight, density: 1000 kg/m^3}
ties:
  pivot: {hinge: {between: [things.plank, world], at: 0 0.55 0 m, axis: 0 0 1}}
forces: [gravity]
contacts: {touch: {collision: {restitution: 0.2, friction: 0.5}}}
clock: {end: 2 s}
"""


def test_a_seesaw_that_flings_a_crate_takes_little_work_and_no_solution_fails(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SEESAW)
    run = Run(load(path, pruned=False))
    energies = [moment.read("things", "energy") for moment in run.moments([0, 0.5, 1, 2])]
    np.testing.assert_allclose(energies, energies[0], rtol=1e-6)
    island = run.islands[0]
    hold = island.assembly.ints_of("sceneql.contacts.rigid_exact.exact_hold_kernels:hold")
    memory = island.march.floats[hold[exact_rows_kernels.MEMORY_AT] :]
    assert memory[exact_rows_kernels.LOOSE] == memory[exact_rows_kernels.JAMMED] == 0
    assert memory[exact_rows_kernels.WORK] < 3e8
    assert island.march.statistics.steps < 200
    assert not island.notes
