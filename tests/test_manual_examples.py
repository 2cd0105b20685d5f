"""Examples on the pages of words, each in one line: entries of a script that has what they name, without errors."""

from __future__ import annotations

import re

import pytest

from sceneql import pipeline
from sceneql.compiler.catalogue import Catalogue
from sceneql.report.manual import manual

EXAMPLE = re.compile(r"^For example\s(`[^`]+`)\.$", re.MULTILINE)
SCENE = """
objects: {{ball: {{sphere: {{radius: 0.2 m, position: 0 2 0 m}}}}, {objects}}}
models:
  fall: {{particles: {{of: ball}}}}
  swing:
    mass_spring:
      masses: {{hook: {{position: 0 2 0 m, fixed: yes}}, bob: {{position: 0.6 1.2 0 m, mass: 1 kg}}}}
      springs: [{{between: [hook, bob], rest: 1 m, stiffness: 40 N/m}}]
  {models}
forces: {{down: gravity, {forces}}}
"""
"""A ball that falls and a mass on a spring: what examples name."""
CATALOGUE = Catalogue()
SHOWN = {
    word: found[1].strip("`")
    for family in CATALOGUE.families
    for word in CATALOGUE.words(family)
    if (found := EXAMPLE.search(manual(CATALOGUE, word))) is not None
}


@pytest.mark.parametrize("word", SHOWN)
def test_the_example_of_a_page_is_an_entry_without_errors(word, tmp_path):
    (family,) = [family for family in CATALOGUE.families if word in CATALOGUE.words(family)]
    inner = dict.fromkeys(("objects", "models", "forces"), "") | {family: SHOWN[word]}
    text = SCENE.format(**inner)
    if family not in ("objects", "models", "forces"):
        text += f"{family}: {{{SHOWN[word]}}}\n"
    (tmp_path / "scene.yaml").write_text(text)
    tasks = pipeline.load(tmp_path / "scene.yaml", pruned=False).tasks
    assert tasks[SHOWN[word].partition(":")[0]].word == word


def test_words_of_a_first_day_have_examples():
    assert {"sphere", "box", "particles", "gravity", "collision", "perspective", "sun", "caption", "graph"} <= set(
        SHOWN
    )
