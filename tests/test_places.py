"""Where outputs stand in the state: what models declare is what reading gives, and nothing that is read off is left."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from runs import complaint
from sceneql.compiler.catalogue import Catalogue
from sceneql.kinds import Model
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run
from sceneql.system import ModelState

GRID = "size: 1 1 m, cell: 0.25 m, coefficient: 0.1, probes: {here: 0.4 0.6 m}"
DROP = "hole: {sphere: {position: 0.5 0.5 0 m, radius: 0.3 m, hidden: yes}}"
MODELS = {
    "cloth": "cloth: {size: 1 1 m, cells: 3 3, mass: 1 kg/m^2, stretch: 10 N/m}",
    "diffusion": f"diffusion: {{{GRID}, initial: x}}",
    "elastic": "elastic: {block: {size: 1 1 1 m, cells: 1 1 1}, element: p1, "
    "law: {linear: {modulus: 1 Pa, poisson: 0.3}}}",
    "equations": 'equations: {start: {a: 1, "a\'": 2, b: 3}, rate: {"a\'\'": -a, b: a*b}, '
    'invariants: {own: b, e: a*b}, gives: {bob: [a, b, "a\'"], twice: 2*a, some: [a, b, 0]}}',
    "equations far": "equations: {start: {a: 1, b: 3}, rate: {a: b, b: -a}, gives: {p: [a, b, a]}, unit: 2 m}",
    "equations many": 'equations: {start: {a: i, b: 3}, rate: {a: "b + i", b: -a}, gives: {p: [b, a, b]}, '
    "copies: {count: 3}}",
    "flow": "flow: {size: 1 1 m, cell: 0.25 m, density: 1 kg/m^3, viscosity: 0.1 Pa*s, "
    "initial: {stream_function: sin(3*x)*y}}",
    "galaxy": "galaxy: {stars: 5, heart: 1 kg, disk: 1 kg, radius: 1 m, constant: 1}",
    "mass_spring": "mass_spring: {masses: {a: {position: 1 2 3 m}, b: {fixed: yes}}, "
    "springs: [{between: [a, b], name: tie}]}",
    "mass_spring lattice": "mass_spring: {lattice: {count: 2 2 2, spacing: 0.1 m}, mass: 1 kg}",
    "membrane": "membrane: {of: ball, law: {tension: 1 N/m}}",
    "particles": "particles: {list: {a: {mass: 1 kg, position: 0 1 0 m}, b: {velocity: 1 2 3 m/s}}}",
    "particles one": "particles: {list: {a: {mass: 2 kg, position: 0 1 0 m}}}",
    "particles of": "particles: {of: ball}",
    "particles positions": "particles: {positions: [[1 m, 2 m, 3 m], [4 m, 5 m, 6 m]]}",
    "rigid": "rigid: {mass: 2 kg, inertia: 1 2 3 kg*m^2, spin: 1 2 3 rad/s, points: {hook: 1 0 0 m}}",
    "rigid several": "rigid: {bodies: {a: {mass: 2 kg, inertia: 1 2 3 kg*m^2, points: {hook: 1 0 0 m}}, "
    "b: {mass: 1 kg, inertia: 1 1 1 kg*m^2, position: 1 0 0 m}}}",
    "reaction_diffusion": "reaction_diffusion: {size: 1 1 m, cell: 0.25 m, probes: {here: 0.4 0.6 m}, "
    "species: {u: {coefficient: 0.1, initial: x, rate: -u*v}, v: {initial: y}}}",
    "wave": "wave: {size: 1 1 m, cell: 0.25 m, speed: 1 m/s, initial: x, velocity: y, probes: {here: 0.4 0.6 m}}",
}
AIR = "{flow: {size: 1 1 m, corner: -0.5 -0.5 m, cell: 0.01 m, density: 1 kg/m^3, viscosity: 0.1 Pa*s}}"
COMPUTED_ALONE = {"flow"}
"""A flow's velocities stand at faces; all its outputs are means at centers."""
COMPUTED = {"momentum"}
OF_REST = {"frequencies", "mode_shapes"}
"""Outputs that no state changes, and that one that is none does not have."""
"""Of a mass of one kilogram momentum and velocity are one number."""
NOT_TOLD = {"center", "hook.position", "a.hook.position"}
"""Outputs that stand in the state of some scenes, or are made of what does; those of `equations` are the script's."""


def run_of(folder: Path, model: str, force: str = "{mutual_gravity: {constant: 1}}") -> Run:
    path = folder / "scene.yaml"
    carried = model.startswith("membrane")
    force, air = ("{immersion: {on: [it], in: air}}", f"  air: {AIR}\n") if carried else (force, "")
    path.write_text(
        "clock: {end: 1 s}\nobjects: {ball: {sphere: {radius: 0.1 m, hidden: yes}}}\n"
        f"models:\n{air}  other: {{particles: {{list: {{o: {{position: 9 9 9 m}}}}}}}}\n  it: {{{model}}}\n"
        f"forces: {{pull: {force}}}\n"
    )
    return Run(load(path, pruned=False))


def probed(kind: Model, output: str, state: ModelState) -> Any:
    """Where an output stands that copies entries of y: found by a state that numbers its own, and seen on another."""
    if output in OF_REST:
        return None
    size = len(state.y)
    numbers = 17.0 + np.arange(size)
    other = np.random.default_rng(2).standard_normal(size)
    with np.errstate(all="ignore"):
        found, again = (np.asarray(kind.read(output, replace(state, y=y)), dtype=float) for y in (numbers, other))
    places = found - 17.0
    if not found.size or not np.all((places >= 0) & (places < size) & (places == np.floor(places))):
        return None
    return places.astype(int) if np.array_equal(other[places.astype(int)], again) else None


def at_start(run: Run, name: str = "it") -> tuple[Model, ModelState]:
    """A model and its view of its island as its places are asked for."""
    island = run.island_of[name]
    island.advance(0.0)
    kind = run.graph.tasks[name].kind
    assert isinstance(kind, Model)
    return kind, replace(island.state(name), t=0.0)


def test_every_model_that_is_solved_is_here():
    words = {word for word in Catalogue().words("models") if not Catalogue().load("models", word).kinematic}
    assert {name.split()[0] for name in MODELS} == words


@pytest.mark.parametrize("name", MODELS)
def test_places_are_where_reading_finds_an_output(tmp_path, name):
    kind, state = at_start(run_of(tmp_path, MODELS[name]))
    chance = np.random.default_rng(5)
    written = next(iter(yaml.safe_load(MODELS[name]).values()))
    declared = []
    for output, gives in type(kind).outputs(written).items():
        places = kind.places(output, state)
        other = probed(kind, output, state)
        assert (places is None) == (other is None or output in COMPUTED), output
        told = gives.computed or output in NOT_TOLD or name.startswith("equations")
        assert not gives.computed if places is not None else told, output
        if places is not None:
            declared.append(output)
            np.testing.assert_array_equal(places, other, err_msg=output)
            for _ in range(3):
                y = chance.standard_normal(len(state.y))
                read = kind.read(output, replace(state, y=y, rate=chance.standard_normal(len(y))))
                np.testing.assert_allclose(y[places], read, rtol=1e-15, err_msg=output)
                assert np.shape(places) == np.shape(read)
    assert bool(declared) == (name not in COMPUTED_ALONE)


def test_what_comes_and_goes_has_no_place(tmp_path):
    kind, state = at_start(run_of(tmp_path, "particles: {emit: {rate: 10 Hz, from: 0 0 0 m, velocity: 1 0 0 m/s}}"))
    assert kind.places("positions", state) is None
    torn = MODELS["cloth"].replace("cells: 3 3", "cells: 3 3, tear: {at: 2}")
    kind, state = at_start(run_of(tmp_path, torn))
    assert kind.places("springs", state) is None
    assert kind.places("positions", state) is not None


@pytest.mark.parametrize("pull", ["[it.momentum.x/(1 N*s), 0, 0]*(1 m)", "it.center"])
def test_a_link_to_what_is_computed_is_refused_with_its_place(tmp_path, pull):
    with pytest.raises(ScriptError, match="is no part of the state that is solved together with this") as told:
        run_of(tmp_path, MODELS["mass_spring"], f"{{attractor: {{position: '{pull}'}}}}")
    assert "scene.yaml" in str(told.value)


READERS = {
    "a force": "forces: [{drag: {linear: READ*(1 kg/s)}}]",
    "a contact": "forces: [{collision: {between: [it, ball], restitution: READ}}]\n"
    "objects: {ball: {sphere: {hidden: yes}}}",
    "a motion": "  led: {motion: {position: [READ*(1 m), 0 m, 0 m]}}\nforces: [{attractor: {position: led.position}}]",
    "an object": "objects: {mark: {sphere: {position: [READ*(1 m), 0 m, 0 m]}}}\n"
    "forces: [{attractor: {position: mark.position, on: it}}]",
    "a rate": "  m: {equations: {start: {x: 1}, rate: {x: -x*READ}}}",
    "an output": "  m: {equations: {start: {x: 1}, rate: {x: -x}, gives: {g: READ}}}",
}
"""What reads READ, behind a model `it`."""


@pytest.mark.parametrize(("output", "unit"), [("kinetic", "1 J"), ("energy", "1 J"), ("p.acceleration", "1 m/s^2")])
@pytest.mark.parametrize("reader", READERS)
def test_check_tells_of_what_is_computed_in_a_rate_at_its_place(tmp_path, reader, output, unit):
    read = READERS[reader].replace("READ", f"(it.{output}{'.x' if output[1] == '.' else ''}/({unit}))")
    model, table = "models:\n  it: {particles: {list: {p: {}}}}", "outputs: {table: {record: {of: it.kinetic}}}"
    told = complaint(tmp_path, f"{model}\n{read}\n{table}\n")
    assert told.startswith(
        f"error[unsupported-link]: 'it.{output}' is no part of the state that is solved together with this\n"
    )
    assert told.count("error[") == 1
    assert told.splitlines()[3].count(f"it.{output}") == 1


def test_colors_of_what_is_solved_may_be_computed(tmp_path):
    net = "{masses: {b: {}, c: {position: 1 0 0 m}}, springs: [{between: [b, c]}], color: hue(it.kinetic/(1 J))}"
    script = f"models:\n  it: {{particles: {{list: {{p: {{}}}}}}}}\n  net: {{mass_spring: {net}}}\n"
    assert complaint(tmp_path, f"{script}outputs: {{still: {{image: {{size: 16 9}}}}}}\n") == ""


WORD = """
from sceneql.kinds import Gives, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.words.models.particles import Particles


class Dust(Particles):
    \"\"\"Particles that say {what} where they stand.\"\"\"

    @classmethod
    def outputs(cls, written):
        return {{**super().outputs(written), "first": Gives(quantity_type(dim.LENGTH, (3,)), "Of the first.")}}

    def read(self, output, state):
        if output == "first":
            at = state.bodies.position_at
            return state.y[at : at + 3].copy()
        return super().read(output, state)
"""
SAID = """
    def places(self, output, state):
        import numpy as np

        if output == "first":
            return state.bodies.position_at + np.arange(3)
        return super().places(output, state)
"""


@pytest.mark.parametrize("said", [True, False])
def test_what_a_model_of_a_words_folder_declares_may_be_read_at_stage_times(tmp_path, said):
    (tmp_path / "models").mkdir()
    what = "also" if said else "never"
    (tmp_path / "models" / "dust.py").write_text(WORD.format(what=what) + (SAID if said else ""))
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\nmodels:\n  it: {dust: {list: {a: {position: 1 0 0 m}}}}\n"
        "  other: {particles: {list: {o: {}}}}\n"
        "forces: {pull: {attractor: {position: it.first, strength: 1 m^3/s^2, on: [other]}}}\n"
    )
    if not said:
        with pytest.raises(ScriptError, match=r"'it\.first' is no part of the state"):
            Run(load(path, pruned=False, words=tmp_path))
        return
    (moment,) = Run(load(path, pruned=False, words=tmp_path)).moments([0.0])
    np.testing.assert_allclose(moment.read("other", "o.acceleration"), [1, 0, 0])
