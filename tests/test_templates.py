"""Templates, parts, copies and defaults written out to entries."""

from __future__ import annotations

import pytest

from sceneql.language.script import Script
from sceneql.language.tree import Scalar
from scripts import entries, found, plain, script

STREET = """
define: {n: 3}
templates:
  lamp:
    fields: {at: , height: 2 m, top: 2*height}
    gives: {lit: bulb.on}
    objects:
      pole: {cylinder: {position: at, height: height}}
      bulb: {sphere: {position: pole.top}}
    lights: [point]
    parts: {foot: {base: {wide: at}}}
  base: {fields: {wide: 1 m}, objects: {plate: {box: {size: wide}}}}
parts:
  one: {lamp: {at: 0 0 0 m}}
  row: {repeat: {count: n, as: i}, lamp: {at: "[i, 0, 0]"}}
objects:
  dust: {repeat: {count: 2}, sphere: {radius: i}}
"""


def test_an_instance_adds_its_entries_under_its_name() -> None:
    read = script(STREET)
    instances = ["one", "row.0", "row.1", "row.2"]
    assert set(read.sections["objects"]) == {
        "dust.0", "dust.1", *(f"{name}.{part}" for name in instances for part in ("pole", "bulb", "foot.plate"))
    }  # fmt: skip
    assert list(read.sections["lights"]) == [f"{name}.point" for name in instances]
    assert read.groups["dust"] == ["dust.0", "dust.1"]
    assert read.groups["row.1"] == ["row.1.pole", "row.1.bulb", "row.1.point", "row.1.foot.plate"]
    assert len(read.groups["row"]) == 12


def test_names_inside_an_instance_are_looked_up_inside_first() -> None:
    read = script(STREET)
    scope = read.sections["objects"]["row.1.bulb"].scope
    assert scope is not None
    resolved = [scope.resolve(name) for name in ("pole", "foot.plate", "lit", "one", "dust")]
    assert resolved == ["row.1.pole", "row.1.foot.plate", "row.1.lit", "one", "dust"]
    inner = read.sections["objects"]["row.1.foot.plate"].scope
    assert inner is not None
    assert inner.resolve("bulb") == "row.1.bulb"
    assert (plain(read.gives["row.2.lit"].node), read.gives["row.2.lit"].scope.resolve("bulb")) == (
        "bulb.on",
        "row.2.bulb",
    )


def field(read: Script, part: str, name: str) -> list[str]:
    """What a name means inside a part, followed outward through the fields to the last text."""
    entry = next(section[part] for section in read.sections.values() if part in section)
    scope, texts = entry.scope, []
    while scope is not None:
        if name in scope.fields:
            node = scope.fields[name]
            assert isinstance(node, Scalar)
            name = node.text.split("*")[-1].split(",")[0].strip("[")
            texts.append(node.text)
        scope = scope.outer
    return texts


def test_a_field_is_read_outside_its_instance() -> None:
    read = script(STREET)
    assert field(read, "row.2.pole", "at") == ["[i, 0, 0]", "2"]
    assert field(read, "row.2.foot.plate", "wide") == ["at", "[i, 0, 0]", "2"]
    assert field(read, "one.pole", "top") == ["2*height", "2 m"]
    assert field(read, "dust.1", "i") == ["1"]


def test_template_faults_are_located() -> None:
    text = """templates:
  leg: {fields: {at: , n: 1}, object: {}, objects: {n: box}}
  self: {parts: {x: self}}
  odd: 3
parts:
  a: leg
  b: {leg: {at: 1, m: 2}}
  c: lag
  d: self
  e: {leg: 3}
"""
    assert found(text) == [
        ("unknown-section", "s.yaml:2:31"),
        ("duplicate-name", "s.yaml:2:53"),
        ("template-cycle", "s.yaml:3:21"),
        ("section-shape", "s.yaml:4:8"),
        ("missing-field", "s.yaml:6:6"),
        ("unknown-field", "s.yaml:7:20"),
        ("unknown-template", "s.yaml:8:6"),
        ("entry-shape", "s.yaml:10:12"),
    ]


@pytest.mark.parametrize(
    ("repeat", "code"),
    [
        ("{count: 20000}", "limit-refused"),
        ("{count: -1}", "repeat-count"),
        ("{count: 1.5}", "repeat-count"),
        ("{count: n}", "repeat-count"),
        ("{count: n + 1}", "repeat-count"),
        ("{count: 3/2}", "repeat-count"),
        ("{count: 2 - 3}", "repeat-count"),
        ("{count: (2 - }", "repeat-count"),
        ("{count: 99999999999999999999}", "limit-refused"),
        ("{}", "repeat-shape"),
        ("3", "repeat-shape"),
        ("{count: 3, as: 2}", "repeat-shape"),
        ("{count: 3, of: x}", "repeat-shape"),
    ],
)
def test_repeat_faults_are_located(repeat: str, code: str) -> None:
    assert found(f"objects: {{a: {{repeat: {repeat}, sphere: {{}}}}}}\ndefine: {{n: n}}")[0][0] == code


def test_a_count_may_be_a_formula_of_defines() -> None:
    read = script("objects: {a: {repeat: {count: 2*m + 1}, sphere: {}}}\ndefine: {n: 3, m: n - 1}")
    assert list(read.sections["objects"]) == [f"a.{k}" for k in range(5)]


def test_a_count_by_a_long_chain_of_defines_is_worked_out_once() -> None:
    chain = ", ".join(f"a{k}: a{k - 1}*a{k - 1}" for k in range(1, 41))
    objects = "objects: {a: {repeat: {count: a40, as: i}, sphere: {}}}\n"
    assert list(script(f"{objects}define: {{a0: 1, {chain}}}").sections["objects"]) == ["a.0"]
    assert found(f"{objects}define: {{a0: a40, {chain}}}")[0][0] == "repeat-count"


def test_copies_of_copies_are_refused_at_once() -> None:
    text = "templates:\n  t0: {objects: [sphere]}\n"
    text += "".join(f"  t{n}: {{parts: {{a: {{repeat: {{count: 9999}}, t{n - 1}: {{}}}}}}}}\n" for n in range(1, 70))
    assert found(text + "parts: {a: t3}")[0][0] == "too-many-parts"
    assert found(text.replace("9999", "1") + "parts: {a: t69}")[0][0] == "too-deep"


def test_defaults_fill_fields_that_are_not_given() -> None:
    read = script(
        "defaults: {sphere: {radius: 1 m, color: red}}\nobjects: {a: sphere, b: {sphere: {radius: 2 m}}, c: box}"
    )
    assert entries(read) == {
        "a": {"sphere": {"radius": "1 m", "color": "red"}},
        "b": {"sphere": {"radius": "2 m", "color": "red"}},
        "c": {"box": None},
    }
    assert found("defaults: {sphere: 3}") == [("section-shape", "s.yaml:1:20")]
