"""The scenes hold what they promise, at any frame rate and with any number of threads.

SCENEQL_LONG=1 measures their numbers at all frames of the whole films, as `sceneql gallery check` does. Else films of
which no expectation names the end are measured as far as the last instant that one names, at least for a part; and at
few frames where these take long.
"""

import math
from pathlib import Path

import pytest

from campaigns import LONG
from sceneql import pipeline
from sceneql.march.equilibrium_march import EquilibriumMarch
from sceneql.quantities.expression import Call, walk
from sceneql.report.expect import outcomes
from sceneql.report.gallery import compare, numbers, poster
from sceneql.run.series import instant_of, plain

SCENES = sorted((Path(__file__).parent.parent / "scenes").glob("*.yaml"))
SOLVED = [path for path in SCENES if "models:" in path.read_text()]
PART = 0.4
FRAMES = 4
SLOW_FRAMES = {"bracket_bends", "double_pendulum", "elastica", "face", "galaxies", "gray_scott", "lake"}
"""Scenes of which a frame is an equilibrium of its own, or takes long to read."""
RATES, FEW_RATES = (6, 15), (2, 5)
"""Numbers of frames of which the physics knows nothing; those of scenes with slow frames."""
ROUGH = ["element=p1", "spacing=25 mm"]
FEWER = {
    "bell": [*(f"models.struck.elastic.{given}" for given in ROUGH), "solvers.main.modal.modes=10"],
    "bowl": [
        "models.parts.rigid.bodies={drilled: {of: drilled}, die: {of: die}, pipe: {of: pipe}, ball: {of: ball}}",
        "contacts.touch.collision.between=[parts, bowl, floor]",
    ],
    "bracket_bends": ["models.large.elastic.spacing=8 cm"],
    "benard": ["define.cells=48", "solvers.main.sbdf2.step=0.8 ms"],
    "capsules": ["define.h=12 mm/30", "solvers.main.sbdf2.step=1 ms"],
    "cushion": ["define.h=2.4 m/40"],
    "dominoes": ["solvers.main.verlet.step=20 ms"],
    "flag": ["define.h=1 m/20"],
    "lake": ["define.h=40 m"],
    "jelly": ["models.cube.mass_spring.lattice.count=4 4 4"],
    "notes_fluid": ["models.water.flow.pressure=auto"],
    "pile": ["models.bun.elastic.spacing=9 cm"],
    "plume": ["define.h=5 cm", "solvers.main.sbdf2.step=25 ms"],
    "ripples": ["models.pond.wave.cell=5 cm", "solvers.main.verlet.step=10 ms"],
    "rollers": ["models.jelly.elastic.spacing=50 mm", "solvers.main.tr_bdf2.step=1/120 s"],
    "treacle_balloon": ["define.h=2.6 m/30"],
}
"""What takes less time, by scene: parts that nothing expects are coarser or left out; larger cells, longer steps."""
COARSER = {
    "bell": [f"models.hum.elastic.{given}" for given in ROUGH],
    "bowl": ["models.parts.rigid.bodies={ring: {of: ring}, die: {of: die}, ball: {of: ball}}"],
    "face": ["models.face.elastic.spacing=24 mm"],
    "bracket_bends": [f"models.{name}.elastic.element=p1" for name in ("large", "small")],
}
"""What else leaves a scene's steps as they are: of these alone the law of frame rates tells."""


LONGER = {
    "flag": "a flag begins to flap after seconds",
    "rollers": "friction on what turns takes half a minute",
    "treacle_balloon": "a deep flow of two fluids takes a minute, and coarser cells spoil its fall by 5 %",
}
"""Scenes whose numbers are measured in the long run alone, and by `gallery check`; why."""


def named(scene):
    return next(path for path in SCENES if path.stem == scene)


def test_there_are_scenes_to_show():
    assert len(SCENES) >= 6


def shortened(graph, variant):
    """Settings by which a scene's expectations of a variant are measured in less time."""
    held = [one for one in graph.settings.expect.values() if one.variant == variant]
    exprs = [value.expr for one in held for value in (one.of, one.value, one.below) if value is not None]
    calls = [node for expr in exprs for node in walk(expr) if isinstance(node, Call)]
    clock = graph.settings.clock
    end = clock.end
    if not any(call.op == "final" for call in calls) and not any(plain(one.of.expr) for one in held):
        end = max([PART * end, *(instant_of(call) for call in calls if call.op == "at")])
    few = [f"clock.fps={FRAMES * clock.speed / end!r}"] * (graph.name in SLOW_FRAMES)
    return [*few, f"clock.end={end!r} s"]


def measured(path):
    """What a scene's expectations measure."""
    if LONG:
        return numbers(path)
    lighter = FEWER.get(path.stem, [])
    graph = pipeline.load(path, sets=lighter)
    found = []
    for variant in dict.fromkeys(expect.variant for expect in graph.settings.expect.values()):
        chosen = graph if variant is None else pipeline.load(path, variant=variant, sets=lighter)
        sets = [*lighter, *shortened(chosen, variant)]
        found += outcomes(pipeline.load(path, variant=variant, sets=sets, pruned=False), variant)
    return found


@pytest.mark.long
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scene_gives_its_numbers_and_says_where_they_are_known_from(path):
    if path.stem in LONGER and not LONG:
        pytest.skip(LONGER[path.stem])
    found = measured(path)
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


@pytest.mark.parametrize("sets", [[], ["solvers.main={rk4: {step: 5 ms}}"]], ids=["own", "fixed"])
def test_a_disk_rolls_in_whole_steps(sets):
    """Of Euler's disk: an account of its contact's energy that took the air's work for it halved each of them thousands
    of times."""
    (moment,) = pipeline.simulate(pipeline.load(named("spinners"), sets=["clock.end=0.2 s", *sets]), [0.2])
    assert max(island.march.statistics.steps for island in moment.run.islands) < 1000


@pytest.mark.long
@pytest.mark.parametrize("path", SOLVED, ids=lambda path: path.stem)
def test_the_physics_does_not_know_the_frame_rate(path):
    """Of a twelfth of the film, at two numbers of frames."""
    lighter, ends = [*FEWER.get(path.stem, []), *COARSER.get(path.stem, [])], []
    whole = pipeline.load(path).settings.clock
    for count in FEW_RATES if path.stem in SLOW_FRAMES else RATES:
        fps = count * 12 * whole.speed / whole.end
        sets = [*lighter, f"clock.fps={fps!r}", f"clock.end={whole.end / 12!r} s"]
        graph = pipeline.load(path, sets=sets, pruned=False)
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
