"""Rendering as one pass: what fails leaves nothing half under its name, and no output knows of another."""

import errno
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sceneql import cli, pipeline
from sceneql.failure import RunFailure, Unsuitable
from sceneql.run import run as running

PROBE = '''
from types import SimpleNamespace
from typing import Any, ClassVar

from sceneql.kinds import Renderer


class Probe(Renderer):
    """Draws the number of the frame, and where the camera is."""

    data: ClassVar[bool] = True

    def draw(self, frame: Any) -> Any:
        import numpy as np

        linear = np.zeros((18, 32, 3))
        linear[..., 0] = frame.index / 255
        linear[..., 1] = max(map(abs, frame.view.origin)) / 255
        return SimpleNamespace(linear=linear, undecided=0)
'''
SCENE = """
clock: {end: 1 s, fps: 4}
models:
  swing:
    mass_spring:
      masses: {wall: {position: 0 0 0 m, fixed: yes}, bob: {position: 1.2 0 0 m, mass: 1 kg}}
      springs: [{between: [wall, bob], rest: 1 m, stiffness: 100 N/m}]
solvers: {main: {rk4: {step: 5 ms}}}
objects: {ball: {sphere: {radius: 0.1 m, position: swing.bob.position}}}
"""
TABLE = "data: {record: {of: [swing.bob.position]}}"
FILM = "film: {images: {size: 32 18, renderer: probe}}"
MP4 = "film: {video: {size: 32 18, renderer: probe}}"


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Scripts with the outputs given; a folder of words has the renderer `probe`; files go to the folder `made`."""
    (tmp_path / "words" / "renderers").mkdir(parents=True)
    (tmp_path / "words" / "renderers" / "probe.py").write_text(PROBE)
    monkeypatch.chdir(tmp_path)

    def load(*outputs, scene=SCENE, sets=()):
        (tmp_path / "s.yaml").write_text(f"{scene}\noutputs: {{{', '.join(outputs)}}}\n")
        return pipeline.load(tmp_path / "s.yaml", words=tmp_path / "words", sets=sets)

    return load


def made(folder="made"):
    return sorted(path.name for path in Path(folder).glob("*"))


def pixels(name):
    return np.asarray(Image.open(name)).tobytes()


def test_an_output_does_not_know_of_others(load):
    pipeline.render(load(FILM), folder=Path("alone"))
    pipeline.render(load("other: {image: {size: 32 18, renderer: probe, time: 0 s}}", FILM, TABLE), folder=Path("made"))
    for k in range(4):
        assert pixels(f"alone/s.{k:04d}.png") == pixels(f"made/s.film.{k:04d}.png")
    assert pixels("alone/s.0000.png") != pixels("alone/s.0001.png")


def test_a_second_render_is_charged_for_its_own_compilations_alone(load):
    graph = load(TABLE)
    pipeline.render(graph, folder=Path("made"))
    again = pipeline.render(graph, folder=Path("made"))
    assert (again.compilations, again.compile_seconds) == (0, 0.0)
    assert again.run_seconds > 0
    assert again.steps == 150  # to the last frame, at 0.75 s


def test_one_file_cannot_hold_two_outputs(load):
    with pytest.raises(Unsuitable, match="2 outputs: film, data"):
        pipeline.render(load(FILM, TABLE), output=Path("x.csv"))


def test_a_folder_that_cannot_be_written_is_told_before_the_run(load, monkeypatch):
    graph = load(TABLE)
    Path("made").write_text("a file, no folder")
    monkeypatch.setattr(running, "Run", None)
    with pytest.raises(OSError, match="made"):
        pipeline.render(graph, folder=Path("made"))


@pytest.mark.parametrize("output", [TABLE, MP4])
def test_a_disk_full_at_the_end_leaves_nothing(load, monkeypatch, output):
    graph = load(output)

    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        pipeline.render(graph, folder=Path("made"))
    assert made() == []


def test_a_disk_full_on_the_way_keeps_what_was_made(load, monkeypatch):
    from renderers.encoders import png

    save = png.Writer._save

    def fill(writer, picture, path):
        if path.stem > "s.film.0001":
            raise OSError(errno.ENOSPC, "No space left on device")
        save(writer, picture, path)

    monkeypatch.setattr(png.Writer, "_save", fill)
    with pytest.raises(OSError, match="No space left") as caught:
        pipeline.render(load(TABLE, FILM, sets=["clock.end=2 s"]), folder=Path("made"))
    assert made() == ["s.data.partial.csv", "s.film.0000.png", "s.film.0001.png"]
    assert sorted(path.name for path in caught.value.kept) == made()


def test_one_output_that_cannot_be_closed_takes_no_other_with_it(load, monkeypatch):
    from renderers.encoders import mp4

    def broken(writer):
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(mp4.Writer, "close", broken)
    with pytest.raises(OSError, match="Input/output") as caught:
        pipeline.render(load(TABLE, MP4, TABLE.replace("data", "more")), folder=Path("made"))
    assert made() == ["s.data.csv", "s.film.partial.mp4", "s.more.partial.csv"]
    assert sorted(path.name for path in caught.value.kept) == made()


def test_a_run_that_explodes_keeps_its_frames_though_the_camera_fits_the_whole_film(load):
    graph = load(FILM, sets=["solvers.main.step=0.4 s", "clock.end=100 s"])
    with pytest.raises(RunFailure, match="swing") as caught:
        pipeline.render(graph, folder=Path("made"))
    assert caught.value.time > 1
    assert "s.yaml:" in str(caught.value)
    assert len(caught.value.kept) >= 4
    assert 0 < np.asarray(Image.open("made/s.0000.png"))[0, 0, 1] < 20  # meters from what it looks at


@pytest.mark.parametrize(
    ("scene", "part", "line"),
    [
        ("objects: {a: {sphere: {position: [log(0.5 - time/1 s)*1 m, 0 m, 0 m]}}}", "a", 1),
        ("objects: {a: {sphere: {radius: 0.5 m - time*1 m/s}}}", "a.radius", 1),
        ("objects: {a: sphere}\ncameras: {c: {perspective: {position: 0 0 1 m, look_at: {z: time*1 m/s}}}}", "c", 2),
        ("objects: {a: sphere}\nlights: {l: {point: {position: [0 m, 1 m*s/(time - time), 0 m]}}}", "l", 2),
        ("objects: {a: sphere}\nbackground: [log(-time/1 s), 0, 0]", "background", 2),
    ],
)
def test_what_cannot_be_drawn_is_told_by_part_time_and_line(load, scene, part, line):
    graph = load("p: {image: {size: 32 18, renderer: probe, time: 1 s}}", scene=scene)
    with pytest.raises(RunFailure) as caught:
        pipeline.render(graph, folder=Path("made"))
    assert (caught.value.part, caught.value.time) == (part, 1.0)
    assert caught.value.span.source.text[: caught.value.span.start].count("\n") == line - 1
    assert made() == []


def test_a_record_holds_what_is_not_finite(load):
    graph = load("data: {record: {of: [1/(time - time)]}}")
    pipeline.render(graph, folder=Path("made"))
    assert Path("made/s.csv").read_text().splitlines()[1] in ("0.0,nan", "0.0,inf")


def test_failures_of_the_disk_have_the_code_of_failed_runs(load, monkeypatch, capsys):
    load(TABLE)
    Path("file").write_text("")
    monkeypatch.setattr("sys.argv", ["sceneql", "render", "s.yaml", "-o", "file/x.csv"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 1
    assert "file" in capsys.readouterr().err
