"""The JSON Schema takes every script in the texts of this suite that `check` takes."""

import ast
from pathlib import Path

import yaml

from sceneql import pipeline
from sceneql.failure import Unsuitable
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.topics import FOLDER, example
from test_schema import SCHEMA, problems, read

HERE = Path(__file__).parent
SECTIONS = SCHEMA["properties"].keys()


def texts():
    """What may be a script: the texts of the tests, the scripts beside them and those of the manual's topics."""
    for path in sorted(HERE.glob("*.py")):
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        pieces = {id(piece) for node in nodes if isinstance(node, ast.JoinedStr) for piece in node.values}
        for node in nodes:
            if (
                id(node) not in pieces
                and isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and ":" in node.value
            ):
                yield path.stem, node.value
    for path in FOLDER.glob("*.md"):
        yield path.stem, example(path.read_text(encoding="utf-8"))
    for one in yaml.safe_load((HERE / "newcomers.yaml").read_text()):
        yield one["mistake"], one["mended"]


def scripts():
    for name, text in texts():
        if not any(f"{section}:" in text for section in SECTIONS):
            continue
        try:
            tree = read(text)
        except (yaml.YAMLError, ValueError):
            continue
        if isinstance(tree, dict) and tree.keys() <= SECTIONS:
            yield name, text, tree


def test_it_takes_every_good_script_of_the_suite(tmp_path):
    known, wrong, count = set(), {}, 0
    for name, text, tree in scripts():
        if text in known:
            continue
        known.add(text)
        (tmp_path / "scene.yaml").write_text(text)
        try:
            pipeline.load(tmp_path / "scene.yaml")
        except (ScriptError, Unsuitable):
            continue
        count += 1
        if found := problems(tree, SCHEMA):
            wrong[f"{name}: {text}"] = found
    assert wrong == {}
    assert count > 100
