"""What users wished to write, in the language's words: all of it is carried, and gives the numbers it promises."""

from pathlib import Path

import pytest

from sceneql import pipeline
from sceneql.report.gallery import numbers

WISHES = sorted((Path(__file__).parent / "wishes").glob("*.yaml"))


@pytest.mark.parametrize("path", WISHES, ids=lambda path: path.stem)
def test_a_wish_is_carried(path):
    graph = pipeline.load(path)
    assert [str(warning) for warning in graph.warnings] == []
    for name in graph.variants.names:
        assert graph.variant(name).tasks
    found = numbers(path)
    assert found
    assert [str(outcome) for outcome in found if not outcome.holds] == []
