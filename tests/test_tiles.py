"""The pool that frames, meshes and steps are divided among."""

import time

import pytest

from sceneql.compiled.kernels import over_tiles


@pytest.mark.parametrize("threads", ["1", "2"])
def test_each_tile_is_worked_on_once_and_none_is_begun_after_an_error(monkeypatch, threads):
    monkeypatch.setenv("SCENEQL_THREADS", threads)
    done = []
    over_tiles(100, done.append)
    assert sorted(done) == list(range(100))
    begun = []

    def work(tile):
        begun.append(tile)
        if tile == 3:
            raise ValueError("of tile 3")
        time.sleep(1e-3)

    with pytest.raises(ValueError, match="of tile 3"):
        over_tiles(100, work)
    assert len(begun) < 20
