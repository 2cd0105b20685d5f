"""Every broken script gives exactly the text beside it: all its errors, each with place, caret and help."""

import ast
import re
import shlex
from pathlib import Path

import pytest

from modules import whole_house
from sceneql import pipeline
from sceneql.failure import LimitRefused, RunFailure
from sceneql.quantities.diagnostic import ScriptError

FOLDER = Path(__file__).parent / "errors"
SCRIPTS = sorted(FOLDER.glob("*.yaml"))
CODE = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
TELLING = {"Diagnostic", "MismatchError", "_Fault", "_error", "_fail", "error", "stop", "warning"}
"""Functions whose first text is a code."""
WITHOUT_SCRIPT = {
    "long-film": "ten thousand frames would be drawn",
    "script-missing": "there is no script",
    "too-large": "the script would be of 64 MB",
    "too-many-nodes": "the script would be of megabytes",
}
"""Codes without a pair, and why; another test tells them."""


def told(script: Path, folder: Path) -> str:
    """What a user is told of a script by its check, and, if it may run, by its run.

    A first line `# options: --variant NAME` or `# options: --set PATH=VALUE` says with what it is read.
    """
    first = script.read_bytes().partition(b"\n")[0].decode(errors="replace")
    options = shlex.split(first.partition("# options:")[2])
    given = dict(zip(options[::2], options[1::2], strict=True))
    sets = [given["--set"]] if "--set" in given else ()
    said = []
    try:
        graph = pipeline.load(script.name, variant=given.get("--variant"), sets=sets)
        said += map(str, graph.warnings)
        said += map(str, pipeline.render(graph, folder=folder, account=True).warnings)
    except (ScriptError, RunFailure, LimitRefused) as error:
        said.append(str(error))
    return "\n\n".join(said)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_error_text(script, monkeypatch, tmp_path):
    monkeypatch.chdir(FOLDER)
    assert told(script, tmp_path) == script.with_suffix(".txt").read_text().rstrip("\n")


def test_there_are_at_least_forty_broken_scripts():
    assert len(SCRIPTS) >= 40


def test_every_error_says_its_place():
    for script in SCRIPTS:
        if script.stem.partition(".")[0] not in ("not-utf8", "empty-script"):
            text = script.with_suffix(".txt").read_text()
            assert f"--> {script.name}:" in text or "--> --set:" in text, script.name


def test_a_pair_tells_the_code_that_it_is_named_by():
    for script in SCRIPTS:
        code = script.stem.partition(".")[0]
        if code != "many-errors":
            assert re.search(rf"^(error|warning)\[{code}\]", script.with_suffix(".txt").read_text(), re.M), script.name


def test_every_code_has_a_pair():
    """The codes are read off the sources: those of no pair are named above with the reason, and told by a test."""
    pairs = {script.stem.partition(".")[0] for script in SCRIPTS}
    assert codes() - pairs == set(WITHOUT_SCRIPT)
    tests = "".join(path.read_text() for path in FOLDER.parent.glob("test_*.py") if path.name != "test_errors.py")
    for code in WITHOUT_SCRIPT:
        assert f'"{code}"' in tests, code


def codes() -> set[str]:
    """The literal first arguments of the calls that make diagnostics."""
    calls = (node for file in whole_house().files for node in file.nodes[ast.Call])
    return {
        call.args[0].value
        for call in calls
        if getattr(call.func, "attr", getattr(call.func, "id", "")) in TELLING
        and call.args
        and isinstance(call.args[0], ast.Constant)
        and CODE.fullmatch(str(call.args[0].value))
    }
