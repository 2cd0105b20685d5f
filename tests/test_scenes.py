"""The scenes hold what they promise, at any frame rate and with any number of threads."""

import math
from pathlib import Path

import pytest

from sceneql import pipeline
from sceneql.march.equilibrium_march import EquilibriumMarch
from sceneql.report.gallery import compare, numbers, poster

SCENES = sorted((Path(__file__).parent.parent / "scenes").glob("*.yaml"))
SOLVED = [path for path in SCENES if "models:" in path.read_text()]


def named(scene):
    return next(path for path in SCENES if path.stem == scene)


def test_there_are_scenes_to_show():
    assert len(SCENES) >= 6


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scene_gives_its_numbers_and_says_where_they_are_known_from(path):
    found = numbers(path)
    assert found
    assert [str(outcome) for outcome in found if not outcome.holds] == []
    assert all(outcome.expect.because.strip() for outcome in found)


@pytest.mark.parametrize("scene", ["first", "orbit", "still_life"])  # quick ones; `gallery check` compares all
def test_a_poster_is_as_it_is_kept(scene):
    kept = named(scene).parent.parent / "gallery" / f"{scene}.png"
    verdict, same = compare(poster(pipeline.load(named(scene))), kept)
    assert same, verdict


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_every_variant_of_a_scene_is_right(path):
    from sceneql.language.script import read_script

    for variant in read_script(path).variants:
        assert pipeline.load(path, variant=variant).tasks


def test_the_ball_hits_and_rests_when_the_series_of_its_bounces_says():
    graph = pipeline.load(named("bounce"))
    (moment,) = pipeline.simulate(graph, [graph.settings.clock.end])
    first = math.sqrt(2 / 9.81)
    assert moment.read("ground", "hits.first.time") == pytest.approx(first, abs=1e-9)
    assert moment.read("ground", "rest.time") == pytest.approx(first * (1 + 0.8) / (1 - 0.8), abs=1e-9)


@pytest.mark.parametrize("path", SOLVED, ids=lambda path: path.stem)
def test_the_physics_does_not_know_the_frame_rate(path):
    ends = []
    for fps in (24, 60):
        graph = pipeline.load(path, sets=[f"clock.fps={fps}", "clock.end=0.4 s"], pruned=False)
        clock = graph.settings.clock
        *_, last = pipeline.simulate(graph, [*clock.frames(clock.fps), clock.end])
        marches = [island.march for island in last.run.islands]
        ends.append([(march.advance(clock.end)[0].copy(), march) for march in marches])
    for (slow, one), (fast, other) in zip(*ends, strict=True):
        if isinstance(one, EquilibriumMarch):  # looks for a rest at each frame, to the tolerance of its solver
            assert fast == pytest.approx(slow, rel=1e-9, abs=1e-12)
        else:
            assert (slow.tobytes(), one.statistics.steps) == (fast.tobytes(), other.statistics.steps)


def test_the_number_of_threads_changes_no_byte(tmp_path, monkeypatch):
    made = []
    for threads in (1, 2):
        monkeypatch.setenv("SCENEQL_THREADS", str(threads))
        record = "{still: {image: {size: 96 54, time: 0.7 s}}, data: {record: {of: [cage.positions, cage.energy]}}}"
        graph = pipeline.load(named("first"), sets=[f"outputs={record}", "clock.end=0.8 s"])
        report = pipeline.render(graph, folder=tmp_path / str(threads))
        made.append({path.name: path.read_bytes() for path in report.files})
    assert made[0] == made[1]
    assert set(made[0]) == {"first.still.png", "first.data.csv"}
