"""Posters are compared by bytes, then by difference; numbers are held to what scripts say."""

import numpy as np
import pytest
from PIL import Image

from sceneql import pipeline
from sceneql.report.expect import outcomes
from sceneql.report.gallery import check, compare, update
from sceneql.run.instant import Instant

SCENE = """
models:
  spring:
    mass_spring:
      masses: {wall: {position: 0 0 0 m, fixed: yes}, bob: {position: 1.5 0 0 m, mass: 1 kg}}
      springs: [{between: [wall, bob], rest: 1 m, stiffness: 100 N/m}]
solvers: {main: {dopri5: {tolerance: 1e-10}}}
clock: {end: 2 s}
outputs: {data: {record: {of: [spring.bob.position]}}}
expect:
  right: {of: final(spring.bob.position.x), value: 1 m + 0.5 m*cos(20), tolerance: 1e-7, because: exact}
  wrong: {of: final(spring.bob.position.x), value: 1 m, tolerance: 1e-7, because: a mistake}
  instant: {of: "at(spring.bob.position.x, 0.123 s)", value: 1 m + 0.5 m*cos(1.23), tolerance: 1e-7, because: exact}
  drift: {of: max(abs(relative_drift(spring.energy))), below: 1e-7, because: conservation}
  slows: {of: max(spring.bob.position.x), below: initial(spring.bob.position.x) + 1 nm, because: exact}
  turns:
    of: at(spring.bob.position.x, 0.2 s)
    value: 2 m - at(spring.bob.position.x, pi/10*1 s + 0.2 s)
    tolerance: 1e-7
    because: exact, half a period later
  place:
    of: length([final(spring.bob.position.x) - 1 m, 0 m, 0 m])
    value: 0.5 m*abs(cos(20))
    tolerance: 1e-7
    because: exact
  late: {of: "at(spring.bob.position.x, 3 s)", below: 9 m, because: the run ends before}
  moves: {of: max(spring.bob.position.x), below: 1.2 m, because: a mistake}
"""


def test_expectations_hold_or_do_not(tmp_path):
    path = tmp_path / "spring.yaml"
    path.write_text(SCENE)
    graph = pipeline.load(path)
    found = {outcome.name: outcome for outcome in outcomes(graph)}
    assert [(warning.code, warning.span.text) for warning in graph.warnings] == [("beyond-end", "3 s")]
    assert {name for name, outcome in found.items() if outcome.holds} == {
        "right",
        "instant",
        "drift",
        "slows",
        "turns",
        "place",
    }
    assert str(found["wrong"]).startswith("DIFFERS")
    assert "exact" in str(found["right"])


MEASURED = """
clock: {end: 1 s, fps: 10}
objects:
  ball: {sphere: {radius: 1 m + time*(1 m/s)}}
expect:
  first: {of: initial(ball.volume), value: 4/3*pi*(1 m)^3, tolerance: 5e-3, because: exact}
  last: {of: final(ball.volume), value: 4/3*pi*(2 m)^3, tolerance: 0.04, because: exact}
  end: {of: ball.volume, value: final(ball.volume), tolerance: 0, because: exact}
  middle: {of: "at(ball.volume, 0.55 s)", value: 4/3*pi*(1.55 m)^3, tolerance: 0.02, because: exact}
  whole: {of: max(ball.pieces), value: 1, tolerance: 0, because: exact}
  fixed: {of: "max(2) + at(1, 0.5 s) + relative_drift(3)", value: initial(4) - final(1), tolerance: 0, because: exact}
"""


def test_a_measure_is_read_only_when_it_counts(tmp_path, monkeypatch):
    read = []

    def measured(self, task, output):
        read.append((output, self.time))
        return plain(self, task, output)

    plain = Instant.read
    monkeypatch.setattr(Instant, "read", measured)
    path = tmp_path / "ball.yaml"
    path.write_text(MEASURED)
    assert all(outcome.holds for outcome in outcomes(pipeline.load(path, pruned=False)))
    assert sorted(time for output, time in read if output == "volume") == pytest.approx([0.0, 0.55, 1.0])
    assert len([time for output, time in read if output == "pieces"]) == 12


@pytest.fixture
def picture():
    y, x = np.mgrid[0:90, 0:160]
    return np.stack([x, y, x + y], axis=-1).astype(np.uint8)


def test_same_bytes_and_noise_of_one_level_pass(tmp_path, picture):
    kept = tmp_path / "kept.png"
    Image.fromarray(picture).save(kept)
    assert compare(picture, kept) == ("ok, the same bytes", True)
    off = picture.copy()
    off[::7, ::5, 1] += 1
    verdict, same = compare(off, kept)
    assert same
    assert verdict.startswith("ok, nearly")


def test_local_damage_another_size_and_no_poster_do_not(tmp_path, picture):
    kept = tmp_path / "kept.png"
    Image.fromarray(picture).save(kept)
    damaged = picture.copy()
    damaged[40:44, 60:64] = 255
    assert not compare(damaged, kept)[1]
    brighter = (255 * (picture / 255.0) ** 0.8).astype(np.uint8)
    assert not compare(brighter, kept)[1]
    assert not compare(picture[:80], kept)[1]
    assert not compare(picture, tmp_path / "none.png")[1]


def test_an_update_of_one_scene_leaves_the_others_on_the_page(tmp_path):
    folder = tmp_path / "gallery"
    folder.mkdir()
    scenes = [tmp_path / f"{name}.yaml" for name in ("b", "a")]
    for scene in scenes:
        scene.write_text(
            f"about: The {scene.stem} of it.\nobjects: {{ball: {{sphere: {{radius: 1 m}}}}}}\n"
            "gallery: {size: 32 18}\nrenderers: {plain: normals}\noutputs: {i: {image: {renderer: plain}}}\n"
        )
        update((scene,), folder)
    page = (folder / "README.md").read_text()
    assert page.index("The a of it.") < page.index("The b of it.")
    assert update((scenes[0],), folder)[0].endswith("b.png")
    assert (folder / "README.md").read_text() == page
    assert check(tuple(scenes), folder)[1]


def test_what_is_one_number_of_the_whole_run_is_that_at_every_instant():
    from sceneql.quantities.expression import Call, Link, Number, Type
    from sceneql.run.series import course

    height = Link("ball", "height", Type(()))
    least = Call("min", (height,), Type(()))
    series = {height: np.array([3.0, 1.0, 2.0])}
    assert course(Call("at", (least, Number(2.0)), Type(())), series, [0.0, 1.0, 2.0]) == 1.0
    assert np.isnan(course(Call("at", (least, Number(2.5)), Type(())), series, [0.0, 1.0, 2.0]))
