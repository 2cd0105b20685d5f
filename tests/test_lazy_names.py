"""Names of modules and functions in strings, by which kernels and solvers are asked for: every one is there."""

import ast
import re

import pytest

from house import unresolved
from modules import text_of, whole_house


@pytest.fixture(scope="module")
def house():
    """All files, read once, and not while tests are collected: their trees are large."""
    return whole_house()


def test_names_are_found_in_strings(house):
    found = {name for file in house.files for _, name in file.strings()}
    assert len(found) > 150
    assert any(name.endswith("gravity_kernels:gravity") for name in found)


def test_what_a_string_names_is_there(house):
    assert unresolved(house) == []


def test_no_name_is_put_together_from_what_is_known_in_a_run_alone(house):
    """But those of words, renderers and encoders, which are files of a folder; generated modules have their own."""
    allowed = {
        "sceneql/compiler/catalogue.py": ("sceneql.words.",),
        "sceneql/tools.py": ("renderers.encoders.",),
        "sceneql/report/explain.py": ("_kernels.py",),  # of a word
    }
    wrong = []
    for file in house.files:
        for node in file.nodes[ast.JoinedStr]:
            if text_of(node, file.texts) is None:
                texts = [part.value for part in node.values if isinstance(part, ast.Constant)]
                texts += [name.id for name in ast.walk(node) if isinstance(name, ast.Name) and name.id == "__package__"]
                started = [
                    text
                    for text in texts
                    if re.match(r"(sceneql|renderers)\.", text) or "_kernels" in text or text == "__package__"
                ]
                fits = allowed.get(file.path.as_posix(), ())
                wrong += [(file.path.name, node.lineno, text) for text in started if text not in fits]
    assert wrong == []
