"""`use`: a part that is another one with some fields changed."""

from __future__ import annotations

import pytest

from sceneql.language.script import Script
from scripts import found, plain, script


def fields(read: Script, name: str) -> object:
    """The word and the fields of a part, as plain values."""
    entry = next(section[name] for section in read.sections.values() if name in section)
    return entry.word, None if entry.fields is None else plain(entry.fields)


def test_fields_that_are_given_replace_those_of_the_part_that_is_used() -> None:
    read = script("""
objects:
  ball: {sphere: {radius: 1 m, position: {x: 1 m, y: 2 m}}}
  twin: {use: ball, position: {x: 3 m}}
  third: {use: twin, radius: 2 m}
""")
    assert fields(read, "ball") == ("sphere", {"radius": "1 m", "position": {"x": "1 m", "y": "2 m"}})
    assert fields(read, "twin") == ("sphere", {"radius": "1 m", "position": {"x": "3 m"}})
    assert fields(read, "third") == ("sphere", {"radius": "2 m", "position": {"x": "3 m"}})


def test_order_does_not_matter_nor_how_the_part_is_written() -> None:
    read = script("objects: {a: {use: b, height: 1 m}, b: {use: c}, c: plane, d: {use: e}, e: {sphere: }}")
    assert [fields(read, name) for name in "abde"] == [
        ("plane", {"height": "1 m"}),
        ("plane", {}),
        ("sphere", {}),
        ("sphere", None),
    ]


def test_copies_are_those_of_the_part_that_is_used_unless_its_own_are_given() -> None:
    read = script("""
objects:
  dust: {repeat: {count: 2}, sphere: {radius: i}}
  more: {use: dust}
  most: {use: dust, repeat: {count: 3}}
  none: {use: one, repeat: {count: 1}}
  one: sphere
""")
    assert [name for name in read.sections["objects"] if name != "one"] == [
        "dust.0", "dust.1", "more.0", "more.1", "most.0", "most.1", "most.2", "none.0"
    ]  # fmt: skip


def test_instances_are_used_as_other_parts_are() -> None:
    read = script("""
templates: {leg: {fields: {at: 0 m, side: 1}, objects: {toe: {sphere: {radius: side}}}}}
parts: {left: {leg: {at: 1 m}}, right: {use: left, side: -1}}
""")
    scope = read.sections["objects"]["right.toe"].scope
    given = {}
    while scope is not None:
        given |= {key: plain(node) for key, node in scope.fields.items()}
        scope = scope.outer
    assert given == {"at": "1 m", "side": "-1"}


def test_a_template_looks_in_itself_first() -> None:
    read = script("""
templates:
  lamp: {objects: {bulb: {sphere: {radius: 1 m}}, other: {use: bulb}, far: {use: rod}}}
objects: {bulb: box, rod: cylinder}
parts: {one: lamp}
""")
    assert fields(read, "one.other") == ("sphere", {"radius": "1 m"})
    assert fields(read, "one.far") == ("cylinder", {})


def test_a_variant_changes_a_field_of_what_uses_another() -> None:
    text = "objects: {ball: {sphere: {radius: 1 m}}, twin: {use: ball}}"
    read = script(text, sets=["twin.radius=3 m"])
    assert fields(read, "ball") == ("sphere", {"radius": "1 m"})
    assert fields(read, "twin") == ("sphere", {"radius": "3 m"})
    both = script(text, sets=["ball.radius=3 m"])
    assert fields(both, "twin") == ("sphere", {"radius": "3 m"})


def test_a_long_chain_is_followed() -> None:
    links = ", ".join(f"p{i}: {{use: p{i + 1}, f{i}: {i}}}" for i in range(3000))
    read = script(f"objects: {{{links}, p3000: sphere}}")
    assert fields(read, "p2990") == ("sphere", {f"f{i}": str(i) for i in range(2990, 3000)})


@pytest.mark.parametrize("text", ["{use: }", "{use: [a]}", "{use: {a: b}}", "{use: 3}"])
def test_what_is_used_is_a_name(text: str) -> None:
    assert [code for code, _ in found(f"objects: {{a: sphere, b: {text}}}")] == ["entry-shape"]


def test_nothing_more_is_said_of_a_part_that_uses_what_is_wrong() -> None:
    wrong = found("objects: {a: {use: b}, b: {use: a}, c: {use: a, radius: 1 m}, d: {use: nobody}, e: {use: d}}")
    assert sorted(code for code, _ in wrong) == ["unknown-name", "use-cycle"]
    assert [code for code, _ in found("objects: {a: 3, b: {use: a}}")] == ["entry-shape"]
