"""`repeat` inside the fields of a part: masses, springs, joints of a skeleton, children, counted or over names."""

import math

import numpy as np
import pytest

from sceneql import pipeline
from sceneql.quantities.diagnostic import ScriptError

CHAIN = """
define: {n: 3}
models:
  chain:
    mass_spring:
      masses:
        hook: {position: 0 2 0 m, fixed: yes}
        bead: {repeat: {count: n, as: i}, position: [0.2 m*(i + 1), 2 m, 0 m], mass: 0.1 kg*(1 + i)}
      springs:
        - {between: [hook, bead.0], stiffness: 100 N/m}
        - {repeat: {count: 2, as: k}, between: ["bead.{k}", "bead.{k + 1}"], stiffness: 50 N/m*(1 + k)}
objects: {last: {sphere: {position: chain.bead.2.position}}}
"""
PLAIN = """
models:
  chain:
    mass_spring:
      masses:
        hook: {position: 0 2 0 m, fixed: yes}
        bead.0: {position: 0.2 2 0 m, mass: 0.1 kg}
        bead.1: {position: 0.4 2 0 m, mass: 0.2 kg}
        bead.2: {position: 0.6 2 0 m, mass: 0.3 kg}
      springs:
        - {between: [hook, bead.0], stiffness: 100 N/m}
        - {between: [bead.0, bead.1], stiffness: 50 N/m}
        - {between: [bead.1, bead.2], stiffness: 100 N/m}
objects: {last: {sphere: {position: chain.bead.2.position}}}
"""


def load(folder, text):
    (folder / "scene.yaml").write_text(text)
    return pipeline.load(folder / "scene.yaml")


def told(folder, text):
    with pytest.raises(ScriptError) as caught:
        load(folder, text)
    return [(one.message, one.span.text, one.help) for one in caught.value.diagnostics]


def numbers(net):
    masses = {name: (one.position, one.mass) for name, one in net.masses.items()}
    return masses, [(spring.between, spring.stiffness) for spring in net.springs]


def test_masses_and_springs_are_those_that_one_would_write_out(tmp_path):
    repeated, plain = (load(tmp_path, text).tasks["chain"].kind for text in (CHAIN, PLAIN))
    masses, springs = numbers(repeated)
    wanted, between = numbers(plain)
    assert masses.keys() == wanted.keys()
    for name, (position, mass) in masses.items():
        assert position == pytest.approx(wanted[name][0])
        assert mass == wanted[name][1] or mass == pytest.approx(wanted[name][1])
    assert [pair for pair, _ in springs] == [pair for pair, _ in between]


def test_a_skeleton_goes_over_names_and_children_are_counted(tmp_path):
    graph = load(
        tmp_path,
        """
templates: {leg: {fields: {at: }, objects: {hip: {group: {position: at}}}}}
parts: {left: {leg: {at: -0.3 1 0 m}}, right: {leg: {at: 0.3 1 0 m}}}
objects:
  skin: {blobby: {skeleton: [{repeat: {leg: [left, right]}, point: leg.hip.position, radius: 0.4 m}]}}
  row: {group: {children: [{repeat: {count: 3, as: j}, sphere: {radius: 5 cm, position: [0.2 m*j, 0 m, 0 m]}}]}}
""",
    )
    links = [part.point.links[0].task for part in graph.tasks["skin"].kind.skeleton]
    assert links == ["left.hip", "right.hip"]
    assert len(graph.tasks["row"].kind.children) == 3


def test_what_is_wrong_in_a_copy_is_told_once_where_it_stands(tmp_path):
    assert told(tmp_path, CHAIN.replace("0.1 kg*", "0.1 s*")) == [
        ("mass is a mass (kg), but this is a time (s)", "0.1 s*(1 + i)", None)
    ]
    seven, eight = told(tmp_path, CHAIN.replace("{k + 1}", "{k + 7}"))
    assert seven[0].startswith("no mass is called 'bead.7'")
    assert eight[0].startswith("no mass is called 'bead.8'")
    assert told(tmp_path, CHAIN.replace("count: n", "count: 20000"))[0][0] == "20,000 copies are more than 10,000"


def test_a_number_in_the_name_of_a_mass_is_told_with_repeat(tmp_path):
    ((message, span, help),) = told(tmp_path, PLAIN.replace("bead.0: {", "'bead_{i}': {"))
    assert (message, span) == ("'bead_{i}' cannot be a name", "'bead_{i}'")
    assert help.startswith("write `bead: {repeat: {count: 5, as: i}, ...}`")


@pytest.mark.parametrize("where", ["before", "behind"])
def test_a_copy_does_not_take_the_place_of_an_entry_of_its_name(tmp_path, where):
    other, copies = "b.1: {position: 0 1 0 m, mass: 3 kg}", "b: {repeat: {count: 2}, position: 1 1 0 m}"
    masses = ", ".join([other, copies] if where == "before" else [copies, other])
    text = f"models: {{n: {{mass_spring: {{masses: {{{masses}}}, springs: [{{between: [b.0, b.1]}}]}}}}}}"
    assert ("a copy of 'b' is called 'b.1', and so is another entry", "b", "give one another name") in told(
        tmp_path, text
    )


def test_a_copy_of_a_part_meets_the_others_by_its_number_in_braces(tmp_path):
    graph = load(
        tmp_path,
        """
define: {far_0: 1 m, far_1: 2 m}
objects:
  ball: {repeat: {count: 2, as: i}, sphere: {radius: 0.1 m, position: ["far_{i} + 0.1 m*i", 1 m, 0 m]}}
  rope: {repeat: {count: 2, as: i}, tube: {through: [0 2 0 m, "ball.{1 - i}.position"], radius: 1 cm}}
templates: {flag: {fields: {at: }, objects: {cloth: {box: {position: at}}}}}
parts: {flag: {repeat: {count: 2, as: k}, flag: {at: "ball.{k}.position"}}}
""",
    )
    places = [graph.tasks[f"ball.{k}"].kind.position.number() for k in (0, 1)]
    assert places == [pytest.approx([1, 1, 0]), pytest.approx([2.1, 1, 0])]
    assert [graph.tasks[f"rope.{k}"].needs for k in (0, 1)] == [("ball.1",), ("ball.0",)]
    assert [graph.tasks[f"flag.{k}.cloth"].needs for k in (0, 1)] == [("ball.0",), ("ball.1",)]


def test_what_is_repeated_in_defaults_is_written_out_wherever_they_stand(tmp_path):
    (tmp_path / "house.yaml").write_text(
        "defaults: {particles: {list: {p: {repeat: {count: 3, as: i}, position: [0.5 m*i, 1 m, 0 m]}}}}\n"
    )
    graph = load(tmp_path, "include: [house.yaml]\nmodels: {dots: {particles: {mass: 1 kg}}}\n")
    assert list(graph.tasks["dots"].kind.list) == ["p.0", "p.1", "p.2"]


def test_braces_elsewhere_are_told_with_what_they_are_for(tmp_path):
    ((message, _, help),) = told(tmp_path, 'objects: {a: {sphere: {radius: "0.1 m*{i}"}}}')
    assert message == "'{' cannot stand in an expression"
    assert "of a copy by `repeat`" in help


def test_a_condition_of_a_copys_number_answers_yes_or_no(tmp_path):
    """`fixed: i == 0` holds the first bead alone; without one it was refused."""
    one = "mass: 0.1 kg*(1 + i)}"
    assert one in CHAIN
    graph = load(tmp_path, CHAIN.replace(one, f"{one[:-1]}, fixed: i == 0}}"))
    masses = graph.tasks["chain"].kind.masses
    assert {name: mass.fixed for name, mass in masses.items()} == {
        "hook": True, "bead.0": True, "bead.1": False, "bead.2": False,
    }  # fmt: skip


@pytest.mark.parametrize(
    "through",
    [
        "bead.position",
        "[bead.position]",
        '[{repeat: {count: 5, as: k}, point: [0.1 m*k, "sin(0.5*k)*(1 m)", "time*(1 m/s)"]}]',
        '[{repeat: {count: 5, as: k}, x: 0.1 m*k, y: "sin(0.5*k)*(1 m)", z: "time*(1 m/s)"}]',
        '[{repeat: {count: 5, as: k}, point: "bead.{k}.position"}]',
    ],
)
def test_a_line_runs_through_computed_places(tmp_path, through):
    """Places of copies in a list, by their numbers or by one name for all: there was no way to write them."""
    text = f"""
objects:
  bead: {{repeat: {{count: 5, as: i}}, sphere: {{position: [0.1 m*i, "sin(0.5*i)*(1 m)", "time*(1 m/s)"]}}}}
  wire: {{tube: {{through: {through}}}}}
clock: {{end: 1 s}}
"""
    (moment,) = pipeline.simulate(load(tmp_path, text), [0.5])
    expected = [[0.1 * k, math.sin(0.5 * k), 0.5] for k in range(5)]
    assert moment.read("wire", "through") == pytest.approx(np.array(expected), abs=1e-15)


def test_masses_that_are_copies_have_one_name_together(tmp_path):
    wire = "wire: {tube: {through: chain.bead.position}}, last:"
    (moment,) = pipeline.simulate(load(tmp_path, CHAIN.replace("last:", wire)), [0.0])
    assert moment.read("wire", "through").tolist() == [[0.2 * (k + 1), 2, 0] for k in range(3)]


def test_a_name_for_all_copies_within_a_template_means_its_own(tmp_path):
    text = """
templates:
  string:
    fields: {high: 1 m}
    gives: {last: bead.2.position}
    objects:
      bead: {repeat: {count: 3, as: i}, sphere: {position: [0.1 m*i, high, 0 m], radius: 1 cm}}
      wire: {tube: {through: bead.position}}
parts: {s: {repeat: {count: 2, as: k}, string: {high: 1 m + 1 m*k}}}
objects: {rope: {tube: {through: s.last}}}
"""
    (moment,) = pipeline.simulate(load(tmp_path, text), [0.0])
    wires = [moment.read(f"s.{k}.wire", "through")[2].tolist() for k in range(2)]
    assert wires == moment.read("rope", "through").tolist() == [[0.2, 1, 0], [0.2, 2, 0]]
