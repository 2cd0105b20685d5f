"""Mistakes of a first day: what each message says, word for word, and the script as one mends it by that alone.

They are forgotten units, wrong brackets and words of other programs.
"""

import re
from pathlib import Path

import pytest
import yaml

import sceneql
from sceneql import pipeline
from sceneql.bodies.bodies import BODY_OUTPUTS
from sceneql.bodies.nets import SIDES
from sceneql.compiler.catalogue import Catalogue
from sceneql.grids.maps.map_names import CONTROLS
from sceneql.quantities.curves import CURVES
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.operations import CONSTANTS, FUNCTIONS
from sceneql.quantities.other_words import OURS
from sceneql.report.schema import schema
from sceneql.report.topics import topics

MISTAKES = {one["mistake"]: one for one in yaml.safe_load(Path(__file__).with_name("newcomers.yaml").read_text())}


READ = [
    "objects: {ball: {sphere: {radius: 2m, position: {x: 1, y: 2}, color: grey, hidden: true}}, cube: box}",
    "objects: {ball: {sphere: {radius: 1 m*2**2/4, color: LightGrey, hidden: No}}}",
    "clock: {end: 1500ms}\nobjects: {ball: {sphere: {position: {keys: {0: 0 0 0, 1: 0 1 0}}}}}",
    'objects: {ball: {sphere: {radius: "where(time == 1 s, 1 m, 2 m)"}}}',
    "define: {a: 1500 /s, b: 3 /m^2, c: 2 /(m*s), d: 5 /min, f: 0 1 0 /s, cold: -4 °C}\nobjects: {ball: sphere}",
    "objects: {ball: {sphere: {position: [0 m, 1 m*sin(6 rad/s*time), 0 m]}}}",
    "define: {at: {keys: {0 s: 0 2 0 m, 1 s: {value: 0 1 0 m}}}}\nobjects: {ball: {sphere: {position: at}}}",
    "objects: {egg: {group: {children: [sphere], scale: {keys: {0 s: 1 1 1, 1 s: 1 2 1}}}}}",
    "objects: {a: {implicit: {field: x^2 + y^2 + z^2 - 1, bounds: {box: [0 0 0, 1 1 1]}}}}",
    "objects: {egg: {group: {children: [sphere], scale: {x: 1, y: {keys: {0 s: 1, 1 s: 2}}, z: 1}}}}",
]
"""What has one meaning alone, though other programs write it so and we do not."""


def load(folder, text):
    (folder / "scene.yaml").write_text(text)
    return pipeline.load(folder / "scene.yaml")


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_with_what_to_write(mistake, tmp_path):
    one = MISTAKES[mistake]
    with pytest.raises(ScriptError) as caught:
        load(tmp_path, one["wrong"])
    assert [text for told in caught.value.diagnostics for text in (told.message, told.help)] == one["told"]


def doubts(graph):
    """Warnings of a script that is a piece: what it defines may be read by nothing."""
    return [one for one in graph.warnings if one.code != "unused-define"]


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_script_mended_as_it_is_told_has_no_mistake(mistake, tmp_path):
    assert not doubts(load(tmp_path, MISTAKES[mistake]["mended"]))


@pytest.mark.parametrize("text", READ)
def test_what_can_mean_one_thing_alone_is_read(text, tmp_path):
    assert not doubts(load(tmp_path, text))


def test_words_of_other_programs_lead_to_names_of_the_language():
    field = Catalogue().load("models", "diffusion")
    outputs = {name for of in ("temperature", "concentration") for name in field.outputs({"of": of})}
    known = {*FUNCTIONS, *CONSTANTS, *outputs, "time", *names_in(schema(Catalogue()))}
    known |= {
        *BODY_OUTPUTS,
        *CONTROLS,
        *CURVES,
        *SIDES,
        "720p",
        "1080p",
        "4k",
        "rest",
        "fields",
    }  # choices, sides, a section of templates
    assert {name for ours in OURS.values() for name in ours} <= known
    assert all(len(set(ours)) == len(ours) for ours in OURS.values())


def names_in(rule):
    """All names of sections, words and fields in a JSON schema."""
    if isinstance(rule, list):
        return {name for item in rule for name in names_in(item)}
    if not isinstance(rule, dict):
        return set()
    return set(rule.get("properties", ())) | {name for item in rule.values() for name in names_in(item)}


def test_pages_that_messages_point_to_are_there():
    catalogue = Catalogue()
    pages = {*topics(), *(word for family in catalogue.families for word in catalogue.words(family))}
    sources = "".join(path.read_text(encoding="utf-8") for path in Path(sceneql.__file__).parent.rglob("*.py"))
    assert set(re.findall(r"`sceneql words (\w+)`", sources)) <= pages
