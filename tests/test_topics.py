"""The manual's topics: their examples are scripts without errors, and their lists have all that there is."""

from __future__ import annotations

import re

import pytest

from sceneql import pipeline
from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import Unsuitable
from sceneql.kinds import Settings
from sceneql.quantities.operations import CONSTANTS, FUNCTIONS
from sceneql.quantities.unit_table import OFFSET_UNITS, SINGLE
from sceneql.report.manual import listing, manual
from sceneql.report.topics import example, topics

TOPICS = sorted(topics())
BESIDE = {
    "materials.yaml": "materials: {gold: {metal: {color: gold}}}",
    "lamps.yaml": "lights: {lamp: {point: {position: 0 3 0 m}}}\nobjects: {ball: {sphere: {material: gold}}}",
}
"""The scripts that the example of `include` takes over."""


@pytest.mark.parametrize("topic", TOPICS)
def test_its_example_is_a_script_without_errors_or_warnings(topic, tmp_path):
    for name, text in BESIDE.items():
        (tmp_path / name).write_text(text)
    script = tmp_path / "scene.yaml"
    script.write_text(example(manual(Catalogue(), topic)))
    graph = pipeline.load(script)
    assert graph.tasks
    assert not graph.warnings
    for variant in graph.variants.names:
        assert not pipeline.load(script, variant=variant).warnings


@pytest.mark.parametrize("topic", TOPICS)
def test_it_names_itself_and_other_topics_and_words(topic):
    text = manual(Catalogue(), topic)
    assert text.startswith(f"{topic}: {topics()[topic]}")
    see = re.search(r"^See also: (.*)\.$", text, re.MULTILINE)
    assert see is not None
    catalogue = Catalogue()
    words = {word for family in catalogue.families for word in catalogue.words(family)}
    for name in re.findall(r"[a-z]\w*", re.sub(r"\([^)]*\)", "", see[1]).replace("and the words", "")):
        assert name in topics() or name in words
    assert not re.search(r"^\{\w+\}$", text, re.MULTILINE)


def test_every_function_constant_and_unit_is_told():
    told = manual(Catalogue(), "functions")
    called = set(re.findall(r"(\w+)\(", told))
    assert {name for name in FUNCTIONS if not name.startswith("euler_")} <= called
    assert all(f"`{name}`" in told for name in CONSTANTS)
    units = manual(Catalogue(), "units")
    assert all(f"`{name}`" in units for name in [*(single[0] for single in SINGLE), *OFFSET_UNITS])


def test_what_a_script_has_besides_families_is_a_topic_or_the_page_of_one():
    language = {"define", "variants", "templates", "defaults", "include", "repeat", "use"}
    settings = {"clock", "expect", "studies"}
    assert settings <= Settings.model_fields.keys()
    assert language | settings <= topics().keys()


def test_the_listing_ends_with_them_and_a_name_that_is_nearly_one_is_answered():
    assert [line.split()[0] for line in listing(Catalogue()).partition("topics:\n")[2].splitlines()] == TOPICS
    with pytest.raises(Unsuitable, match="'functions'"):
        manual(Catalogue(), "function")


@pytest.mark.parametrize("name", ["where", "hue", "random"])
def test_a_function_has_the_page_of_functions(name):
    assert manual(Catalogue(), name) == manual(Catalogue(), "functions")


@pytest.mark.parametrize(("word", "help"), [("if", "where(condition"), ("vec3", "[x, y, z]"), ("lerp", "'mix'")])
def test_words_of_other_programs_have_ours_in_the_manual_too(word, help):
    with pytest.raises(Unsuitable, match=re.escape(help)):
        manual(Catalogue(), word)


@pytest.mark.parametrize("family", ["lights", "light", "cameras", "material", "ties"])
def test_a_family_is_told_by_its_words(family):
    catalogue = Catalogue()
    named = next(one for one in catalogue.families if one.startswith(family))
    first, *lines = manual(catalogue, family).splitlines()
    assert first == f"{named}:"
    assert [line.split()[0] for line in lines] == list(catalogue.words(named))
    assert f"{first}\n{lines[0]}\n" in listing(catalogue)
