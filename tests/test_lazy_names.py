"""Names of modules and functions in strings, by which kernels and solvers are asked for: every one is there."""

import ast
import re
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FILES = sorted([*(ROOT / "sceneql").rglob("*.py"), *(ROOT / "renderers").rglob("*.py")])
NAME = re.compile(r"(?:sceneql|renderers)(?:\.[a-z_0-9]+)+(?::\w+)?")
NO_CODE = {"sceneql.schema.json", "sceneql.words"}
"""A file, and the entry points of installed words."""


def constants(tree):
    """Texts of the constants of a module, by name."""
    return {
        target.id: node.value.value
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        for target in node.targets
        if isinstance(target, ast.Name)
    }


def text_of(node, known):
    """What a string or an f-string of constants says; None where it is put together from something else."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else None
    parts = []
    for part in node.values:
        if isinstance(part, ast.FormattedValue):
            part = part.value
            if not (isinstance(part, ast.Name) and part.id in known):
                return None
            parts.append(known[part.id])
        else:
            parts.append(part.value)
    return "".join(parts)


def names(path):
    """(line, name) of every string that is the name of something of ours."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    known = constants(tree)
    inner = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in ast.walk(node)} - {
        id(node) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant | ast.JoinedStr) and id(node) not in inner:
            text = text_of(node, known)
            if text is not None and NAME.fullmatch(text) and text not in NO_CODE:
                yield node.lineno, text


ALL = sorted({name for path in FILES for _, name in names(path)})


def test_names_are_found_in_strings():
    assert len(ALL) > 150
    assert any(name.endswith("gravity_kernels:gravity") for name in ALL)


@pytest.mark.parametrize("name", [name for name in ALL if ":" not in name])
def test_a_module_that_a_string_names_is_there(name):
    outer, _, last = name.rpartition(".")
    assert (
        find_spec(name) is not None
        if find_spec(outer).submodule_search_locations
        else hasattr(import_module(outer), last)
    )


@pytest.mark.parametrize("name", [name for name in ALL if ":" in name])
def test_a_function_that_a_string_names_is_there(name):
    module, _, function = name.partition(":")
    path = Path(find_spec(module).origin)
    defined = {
        target
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        for target in (
            [node.name]
            if isinstance(node, ast.FunctionDef | ast.ClassDef)
            else [one.id for one in node.targets if isinstance(one, ast.Name)]
            if isinstance(node, ast.Assign)
            else [one.asname or one.name for one in node.names]
            if isinstance(node, ast.ImportFrom)
            else []
        )
    }
    assert function in defined


def test_no_name_is_put_together_from_what_is_known_in_a_run_alone():
    """But those of words, renderers and encoders, which are files of a folder; generated modules have their own."""
    allowed = {
        "sceneql/compiler/catalogue.py": ("sceneql.words.",),
        "sceneql/pipeline.py": ("renderers.encoders.",),
        "sceneql/report/explain.py": ("_kernels.py",),  # of a word
    }
    wrong = []
    for path in FILES:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        known = constants(tree)
        for node in ast.walk(tree):
            if isinstance(node, ast.JoinedStr) and text_of(node, known) is None:
                texts = [part.value for part in node.values if isinstance(part, ast.Constant)]
                started = [text for text in texts if re.match(r"(sceneql|renderers)\.", text) or "_kernels" in text]
                fits = allowed.get(path.relative_to(ROOT).as_posix(), ())
                wrong += [(path.name, node.lineno, text) for text in started if text not in fits]
    assert wrong == []
