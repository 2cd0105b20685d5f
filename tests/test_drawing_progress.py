"""How far a picture is that takes long, as the progress bar tells."""

import time

from renderers.tracing.picture import BAND, over_rows
from sceneql import doing


def test_a_picture_tells_how_far_it_is(monkeypatch):
    monkeypatch.setenv("SCENEQL_THREADS", "1")
    told = []

    def work(start, stop):
        told.append((start, stop, doing.now(0.0)))
        time.sleep(0.001)

    over_rows(4 * BAND + 1, work, "tracing rays")
    assert [what for *_, what in told[1:]] == [f"tracing rays, {k} %" for k in (20, 40, 60, 80)]
    assert told[-1][:2] == (4 * BAND, 4 * BAND + 1)
    assert doing.now(0.0) == ""
