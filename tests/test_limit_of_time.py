"""`render --limit`: a run that takes too long ends where it is told, and keeps what it has made."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import av
import pytest
from click.testing import CliRunner

from sceneql import cli, exits, interrupts, pipeline
from sceneql.failure import OutOfTime

LONG = """\
clock: {end: 2 s}
models:
  net: {mass_spring: {cloth: {cells: 3 3}, mass: 1 g, stiffness: 1e11 N/m, pins: [top]}}
forces: [gravity]
solvers: {main: {rk4: {step: 1e-10 s}}}
outputs: {still: {image: {size: 32 18, time: 1 s}}}
"""
FILM = """\
clock: {end: 10000 s, fps: 30}
objects: {ball: {sphere: {radius: 0.2 m, position: 0 1 0 m}}}
outputs: {film: {video: {size: 32 18, renderer: normals}}}
"""


def written(folder, script):
    path = folder / "s.yaml"
    path.write_text(script, encoding="utf-8")
    return path


def test_a_march_of_hours_ends_at_its_limit_where_it_is(tmp_path):
    short = LONG.replace("1e11 N/m", "1 N/m").replace("1e-10", "1e-3")
    made = pipeline.render(pipeline.load(written(tmp_path, short)), folder=tmp_path, limit=300.0).files
    assert [one.name for one in made] == ["s.png"]  # and what is compiled is compiled
    path = written(tmp_path, LONG)
    signals = [signal.getsignal(number) for number in (*interrupts.SIGNALS, signal.SIGALRM)]
    began = time.monotonic()
    with pytest.raises(OutOfTime) as found:
        pipeline.render(pipeline.load(path), folder=tmp_path, limit=0.7)
    assert time.monotonic() - began < 30.0
    told = found.value
    assert (told.part, told.span.line) == ("net", 3)
    assert 0.0 < told.time < 1e-3
    assert "the limit of 0.7 s has passed, when solving, at " in told.message
    assert "steps of 1e-10 s, to the next instant" in told.message
    assert [signal.getsignal(number) for number in (*interrupts.SIGNALS, signal.SIGALRM)] == signals
    assert pipeline.render(pipeline.load(written(tmp_path, short)), folder=tmp_path, limit=300.0).files == made


def test_where_nothing_is_simulated_the_limit_ends_an_output(tmp_path):
    path = written(tmp_path, FILM)
    with pytest.raises(OutOfTime) as found:
        pipeline.render(pipeline.load(path), folder=tmp_path, limit=1e-6)
    assert (found.value.part, found.value.span.line) == ("film", 3)


def test_the_signal_of_a_limit_that_has_been_told_raises_nothing():
    """It came in what follows, as of keeping files, where a lock held it up or a C library had lost it."""
    with interrupts.within(300.0, lambda: "waiting") as limit:
        limit.passed = True  # and its signal is late
        with pytest.raises(KeyboardInterrupt):
            limit.look()
        signal.raise_signal(signal.SIGALRM)


def test_a_film_that_takes_too_long_keeps_its_frames(tmp_path):
    path = written(tmp_path, FILM)
    pipeline.render(pipeline.load(path, sets=["clock.end=0.1 s"]), folder=tmp_path)  # what is compiled is compiled
    with pytest.raises(OutOfTime) as found:
        pipeline.render(pipeline.load(path), folder=tmp_path, limit=1.0)
    (kept,) = found.value.kept
    assert kept.name == "s.partial.mp4"
    with av.open(str(kept)) as film:
        frames = sum(1 for _ in film.decode(video=0))
    assert frames == pytest.approx(30.0 * found.value.time, abs=2)


def test_the_program_fails_at_its_limit_though_ctrl_c_is_switched_off(tmp_path):
    """As shells do for what they run beside."""
    written(tmp_path, LONG)
    process = subprocess.run(
        [sys.executable, "-m", "sceneql", "render", "s.yaml", "--limit", "1500 ms"],
        cwd=tmp_path, capture_output=True, text=True, timeout=300,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    )  # fmt: skip
    assert process.returncode == exits.RUN_FAILED, process.stderr
    assert process.stderr.startswith("error[out-of-time]: at ")
    assert "net: the limit of 1.5 s has passed, when " in process.stderr
    assert "--> s.yaml:3:3" in process.stderr
    assert "help: allow more by `--limit`" in process.stderr


def test_a_film_that_is_run_ahead_of_too_long_is_helped_by_larger_steps(tmp_path):
    """The colors of its first frame are those of all: what takes long there is no drawing."""
    heat = "{size: 1 1 m, cell: 5 cm, coefficient: 0.05 m^2/s, source: sin(30*t)*x}"
    script = (
        f"clock: {{end: 1000 s, fps: 0.01}}\nmodels: {{heat: {{diffusion: {heat}}}}}\n"
        "objects: {map: {field_map: {of: heat.concentration}}}\nsolvers: {main: {rk4: {step: 10 us}}}\n"
        "outputs: {film: {images: {size: 32 18}}}\n"
    )
    path = written(tmp_path, script)
    pipeline.render(pipeline.load(path, sets=["clock.end=1 ms", "clock.fps=1000"]), folder=tmp_path)
    with pytest.raises(OutOfTime) as found:
        pipeline.render(pipeline.load(path), folder=tmp_path, limit=2.0)
    assert "when solving" in found.value.message
    assert "larger steps and coarser models take less" in found.value.diagnostic.help


def test_a_limit_beyond_what_a_clock_counts_is_none(tmp_path, capfd):
    path = written(tmp_path, FILM)
    report = pipeline.render(pipeline.load(path, sets=["clock.end=0.1 s"]), folder=tmp_path, limit=1e300)
    assert [made.name for made in report.files] == ["s.mp4"]
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("limit", ["3 kg", "0", "-1 s", "soon"])
def test_what_is_no_time_is_refused(tmp_path, limit):
    path = written(tmp_path, FILM)
    told = CliRunner().invoke(cli.cli, ["render", str(path), "--limit", limit])
    assert told.exit_code == exits.USAGE
    assert f"'{limit}' is no time above 0, as 20s or 2min" in told.output
