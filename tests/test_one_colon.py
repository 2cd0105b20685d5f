"""A colon dropped or doubled in a scene of the gallery gives one error, at its own line, and none another.

The class: the colon behind the first key of a line of a right scene, where that key is not in quotes. Left out are
defines that hide a constant (`e`): where such a line is not read, its name still means the constant.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from sceneql import pipeline
from sceneql.language.compose import compose
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.span import Source

SCENES = Path(__file__).parents[1] / "scenes"
SAMPLE = ("algebraic", "arcade", "creature", "first", "four_solvers", "lake", "soft_train", "tearing_cloth")
MOST = 12
"""Mutations of a scene in a run."""
KEY = re.compile(r"(?P<key>[ ]*(?:- +)*\{?[^\s:#\[\]{}\"]+):(?=\s|$)")
WAYS = {"dropped": r"\g<key>", "doubled": r"\g<key>::"}


def mutations(text: str) -> Iterator[tuple[int, str, str]]:
    lines = text.splitlines(keepends=True)
    for number, line in enumerate(lines, 1):
        for way, written in WAYS.items():
            if (mutated := KEY.sub(written, line, count=1)) != line:
                yield number, way, "".join([*lines[: number - 1], mutated, *lines[number:]])


def lines_told(script: Path) -> list[int]:
    try:
        pipeline.load(script)
    except ScriptError as error:
        return [diagnostic.span.line for diagnostic in error.diagnostics if diagnostic.span is not None]
    return []


@pytest.fixture
def script(tmp_path):
    """Where a scene may be written, beside what scenes include or read."""
    for other in SCENES.iterdir():
        (tmp_path / other.name).symlink_to(other)
    return tmp_path / "mutated.yaml"


@pytest.mark.parametrize("name", SAMPLE)
def test_one_colon_gives_one_error_at_its_line(name, script):
    every = [*mutations((SCENES / f"{name}.yaml").read_text())]
    assert len(every) > 30
    for number, way, text in random.Random(name).sample(every, MOST):
        script.write_text(text)
        assert lines_told(script) == [number], f"the colon of line {number} {way}"


@pytest.mark.parametrize(
    ("name", "start"),
    [
        ("first", "  k"),  # all of the defines, which variants change
        ("four_solvers", "variants"),  # an overlay asks for each of them
        ("soft_train", "          along"),  # an alias names what stands there
        ("bracket", "      of"),  # says what dimension the part's outputs have
        ("drops", "  r"),  # a comment ends the line
        ("creature", "        - {polyline"),  # a list that YAML cuts at its commas
        ("soft_train", "    fields"),  # parts are given these
    ],
)
def test_what_hangs_on_a_line_is_not_told(name, start, script):
    text = (SCENES / f"{name}.yaml").read_text()
    number = next(number for number, line in enumerate(text.splitlines(), 1) if line.startswith(f"{start}:"))
    script.write_text(text.replace(f"\n{start}:", f"\n{start}", 1))
    assert lines_told(script) == [number]


def test_a_list_with_a_unit_is_no_key():
    with pytest.raises(ScriptError) as error:
        compose(Source("scene.yaml", "a: {[[0, 1], [1, 0]] m: 1, b: 2}\n"))
    assert {diagnostic.code for diagnostic in error.value.diagnostics} == {"unit-after-bracket"}
