"""Outputs of a ``--words`` folder that fail are told as any part of a run."""

import pytest

from sceneql import pipeline
from sceneql.failure import RunFailure

TALLY = """\
from sceneql.kinds import Output


class Sums:
    def take(self, moment):
        if moment.time >= FROM:
            float("x")

    def close(self):
        return ()

    def abort(self):
        return ()


class Tally(Output):
    '''It fails from an instant on.'''

    def times(self, clock):
        return [0.0, 1.0]

    def open(self, tools):
        if FROM < 0.0:
            float("x")
        return Sums()
"""


@pytest.mark.parametrize(("fails_from", "time"), [("-1.0", "0"), ("0.5", "1")])
def test_an_output_of_a_words_folder_that_fails_is_named_with_its_time_and_line(fails_from, time, tmp_path):
    folder = tmp_path / "words" / "outputs"
    folder.mkdir(parents=True)
    (folder / "tally.py").write_text(TALLY.replace("FROM", fails_from))
    script = tmp_path / "scene.yaml"
    script.write_text("outputs: {sums: {tally: {}}}\n")
    with pytest.raises(RunFailure, match=rf"at {time} s, sums: could not convert(?s:.*)scene\.yaml:1:11"):
        pipeline.render(pipeline.load(script, words=tmp_path / "words"), folder=tmp_path)
