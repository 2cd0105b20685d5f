"""`render --draft`: the same picture of a ninth of the pixels, enlarged; refused by renderers that have none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from renderers.drafts import COARSER, coarser, enlarged
from renderers.trace import DRAFT_BOUNCES, DRAFT_SAMPLES, Trace
from sceneql import pipeline
from sceneql.cli import cli
from sceneql.failure import Unsuitable
from sceneql.frame import View

SCENE = """
objects:
  ball: {sphere: {radius: 0.5 m, position: 0 1 0 m, color: tomato}}
  ground: {plane: {color: white}}
lights: {sun: {sun: {direction: 0 1 0}}, around: {sky: {strength: 0.3}}}
cameras: {eye: {perspective: {position: 0 2 5 m, look_at: 0 0.6 0 m}}}
outputs: {still: {image: {size: 121 70}}}
"""


def picture(script: Path, name: str, draft: bool) -> np.ndarray:
    from PIL import Image

    (path,) = pipeline.render(pipeline.load(script), output=script.with_name(name), draft=draft).files
    return np.array(Image.open(path)).astype(float)


def test_it_is_the_picture_less_sharp_in_its_own_size_with_its_shadow(tmp_path, monkeypatch):
    script = tmp_path / "scene.yaml"
    script.write_text(SCENE)
    drawn = []
    draw = Trace.draw

    def counted(self, frame):
        drawn.append((frame.view.size, self.samples))
        return draw(self, frame)

    monkeypatch.setattr(Trace, "draw", counted)
    full, draft = picture(script, "full.png", draft=False), picture(script, "draft.png", draft=True)
    assert drawn == [((121, 70), 8), ((41, 24), DRAFT_SAMPLES)]
    assert draft.shape == full.shape
    off = np.abs(draft - full).max(axis=2)
    assert np.mean(off) < 4.0
    assert np.mean(off > 20.0) < 0.06  # along edges
    column = full[:, 60].sum(axis=1)
    below = int(np.argmin(column[40:])) + 40  # the darkest place, under the ball
    assert draft[below, 60].sum() < 0.75 * draft[below, 10].sum()


@pytest.mark.parametrize("size", [(640, 360), (121, 70), (31, 20), (100, 99)])
def test_what_is_seen_stays_at_its_place(size):
    view = View((0.0, 0.0, 0.0), np.eye(3), size, 0.5)
    small = coarser(view)
    assert all(COARSER * few >= many for few, many in zip(small.size, size, strict=True))
    assert small.half_height / small.size[1] == pytest.approx(COARSER * view.half_height / view.size[1])
    # A picture whose colors are the places of its pixels comes back with these at theirs.
    wide, high = small.size
    x = (np.arange(wide) + 0.5 - wide / 2) * COARSER
    y = (np.arange(high) + 0.5 - high / 2) * COARSER
    scale = 100.0 / max(COARSER * wide, COARSER * high)
    ramp = np.stack(np.broadcast_arrays(128.0 + scale * x, 128.0 + scale * y[:, None], 0.0), axis=2)
    found = enlarged(np.rint(ramp).astype(np.uint8), size)
    assert found.shape == (size[1], size[0], 3)
    here = slice(size[1] // 3, size[1] - size[1] // 3), slice(size[0] // 3, size[0] - size[0] // 3)
    wanted = 128.0 + scale * (np.arange(size[0]) + 0.5 - size[0] / 2)
    assert np.abs(found[here][..., 0] - wanted[here[1]]).max(initial=0.0) <= 1.5


def test_a_renderer_without_drafts_refuses_in_words(tmp_path):
    script = tmp_path / "scene.yaml"
    script.write_text(SCENE.replace("image: {", "image: {renderer: quick, ") + "renderers: {quick: normals}\n")
    with pytest.raises(
        Unsuitable, match="'still' is drawn by 'normals', of which there is no draft: leave out --draft"
    ):
        pipeline.render(pipeline.load(script), draft=True)


def test_the_command_line_has_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE)
    told = CliRunner().invoke(cli, ["render", "scene.yaml", "--draft"])
    assert (told.exit_code, (tmp_path / "scene.png").exists()) == (0, True)
    assert "made scene.png" in told.output


def test_a_draft_never_draws_more_finely_than_is_written():
    full = Trace().draft()
    assert (full.samples, full.diffuse_bounces) == (DRAFT_SAMPLES, DRAFT_BOUNCES)
    assert Trace().samples > DRAFT_SAMPLES
    plain = Trace(samples=1, diffuse_bounces=0).draft()
    assert (plain.samples, plain.diffuse_bounces) == (1, 0)
