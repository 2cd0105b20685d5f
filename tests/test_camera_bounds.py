"""A camera whose window the script places looks at no other instant of the film."""

from __future__ import annotations

import pytest

from sceneql import pipeline
from sceneql.run import run
from sceneql.run.dry_run import dry_run

SCENE = """
clock: {{end: 1 s, fps: 4}}
models: {{way: {{motion: {{position: "[2 m*time/(1 s), 0 m, 5 m*time/(1 s)]"}}}}}}
objects: {{ball: {{sphere: {{radius: 0.3 m, position: way.position}}}}, floor: {{plane: {{}}}}}}
cameras: {{c: {{orthographic: {{{camera}}}}}}}
outputs: {{film: {{images: {{size: 16 9, renderer: normals}}}}}}
"""


@pytest.mark.parametrize(
    ("camera", "surveys"),
    [("height: 4 m, look_at: 0 0 0 m", 0), ("height: 4 m, follow: ball", 0), ("height: 4 m", 1), ("fit: [ball]", 1)],
)
def test_the_film_is_surveyed_only_for_a_fit(tmp_path, monkeypatch, camera, surveys):
    asked = []
    survey = run.dry_run
    monkeypatch.setattr(run, "dry_run", lambda *args, **more: asked.append(1) or survey(*args, **more))
    (tmp_path / "s.yaml").write_text(SCENE.format(camera=camera))
    report = pipeline.render(pipeline.load(tmp_path / "s.yaml"), folder=tmp_path)
    assert report.frames == 4
    assert len(asked) == surveys


HEAT = """
clock: {{end: 1 s}}
models: {{plate: {{diffusion: {{size: 1 1 m, cell: 0.25 m, coefficient: 0.01 m^2/s, initial: x}}}}}}
objects:
  map: {{group: {{children: [sheet], rotation: {{about: x, angle: {turn}}}}}}}
  sheet: {{field_map: {{of: plate.concentration, contours: [0.5 kg/m^3]{more}}}}}
  ball: {{sphere: {{radius: 0.1 m, color: hue(time/(1 s))}}}}
"""


@pytest.mark.parametrize(
    ("turn", "more", "whole"),
    [("90 deg", "", False), ("90 deg*time/(1 s)", "", True), ("90 deg", ", height: 1 m^4/kg", True)],
)
def test_colors_alone_take_no_run_ahead_to_its_end(tmp_path, turn, more, whole):
    (tmp_path / "s.yaml").write_text(HEAT.format(turn=turn, more=more))
    ahead = dry_run(run.Run(pipeline.load(tmp_path / "s.yaml"), ahead=True))
    assert ahead.times[-1] == (1.0 if whole else 0.0)
