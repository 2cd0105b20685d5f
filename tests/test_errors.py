"""Every broken script gives exactly the text beside it: all its errors, each with place, caret and help."""

from pathlib import Path

import pytest

from sceneql import pipeline
from sceneql.quantities.diagnostic import ScriptError

FOLDER = Path(__file__).parent / "errors"
SCRIPTS = sorted(FOLDER.glob("*.yaml"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_error_text(script, monkeypatch):
    monkeypatch.chdir(FOLDER)
    with pytest.raises(ScriptError) as error:
        pipeline.load(script.name)
    assert str(error.value) == script.with_suffix(".txt").read_text().rstrip("\n")


def test_there_are_at_least_forty_broken_scripts():
    assert len(SCRIPTS) >= 40


def test_every_error_says_its_place():
    for script in SCRIPTS:
        if script.stem.partition(".")[0] not in ("not-utf8", "too-large", "empty-script"):
            assert f"--> {script.name}:" in script.with_suffix(".txt").read_text(), script.name
