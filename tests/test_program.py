"""The program as its users meet it: commands, exit codes, files that are whole or not there, messages."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml

from sceneql.compiler.catalogue import Catalogue
from sceneql.report.schema import schema

SCENES = Path(__file__).parent.parent / "scenes"
STILL = """
objects:
  ball: {sphere: {radius: 0.2 m, position: 0 1 0 m}}
outputs: {still: {image: {size: 32 18, time: 0 s}}}
"""
SPRING = """
define: {{dt: {step}}}
clock: {{end: {end}, fps: 10}}
models:
  swing:
    mass_spring:
      masses: {{wall: {{position: 0 0 0 m, fixed: yes}}, bob: {{position: 1.2 0 0 m, mass: 1 kg}}}}
      springs: [{{between: [wall, bob], rest: 0 m, stiffness: 100 N/m}}]
solvers: {{main: {{{solver}: {{step: dt}}}}}}
outputs: {{{output}}}
"""
RECORD = "data: {record: {of: [swing.bob.position]}}"
BOUND = 2 * math.sqrt(2) / 10
"""Largest stable step [s] of rk4 on an oscillation of 10 rad/s."""


def sceneql(folder, *args, code=0):
    done = subprocess.run(
        [sys.executable, "-m", "sceneql", *args], cwd=folder, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == code, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return done.stdout + done.stderr


def test_check_tells_the_mistakes_of_all_variants(tmp_path):
    script = STILL + "variants: {a: {objects.ball.radus: 1 m}, b: {}, c: {objects.ball.radius: 1 s}}\n"
    (tmp_path / "still.yaml").write_text(script)
    said = sceneql(tmp_path, "check", "still.yaml", code=3)
    assert "2 errors" in said
    assert said.index("radus") < said.index("1 s")


def test_check_warns_of_what_a_variant_says_to_no_effect(tmp_path):
    text = SPRING.format(step="0.01 s", end="0.1 s", solver="rk4", output=RECORD)
    (tmp_path / "s.yaml").write_text(text + "variants: {stiff: {swing.stiffness: 200 N/m}}\n")
    assert "no spring reads its `stiffness`" in sceneql(tmp_path, "check", "s.yaml")


def test_a_broken_value_beside_variants_is_told_once(tmp_path):
    """The variants, of which the same mistake was not told again, went on without the part and ended in a KeyError."""
    text = STILL.replace("radius: 0.2 m", "radius: random(1, 3) s") + "models: {fall: {particles: {of: ball}}}\n"
    (tmp_path / "s.yaml").write_text("define: {k: 1}\n" + text + "variants: {other: {define.k: 2}}\n")
    assert "1 error" in sceneql(tmp_path, "check", "s.yaml", code=3)


def test_an_object_by_the_name_of_a_material_does_not_hide_it(tmp_path):
    """It was refused with the advice to write what stood there."""
    (tmp_path / "s.yaml").write_text(STILL.replace("ball: {sphere: {", "mirror: {sphere: {material: mirror, "))
    assert "ok" in sceneql(tmp_path, "check", "s.yaml")


def test_options_and_commands_of_other_programs_are_told_with_what_to_write(tmp_path):
    for told, *given in (
        ("help: write `sceneql render ball.yaml`", "ball.yaml"),
        ("help: write `--set clock.fps=60`", "render", "ball.yaml", "--fps", "60"),
        ("--set 'outputs={still: {image: {size: 480 270, time: 1 s}}}'`", "render", "ball.yaml", "--size", "480 270"),
    ):
        assert told in sceneql(tmp_path, *given, code=2)


def test_no_library_warns_of_numbers_that_are_too_large(tmp_path):
    script = "objects: {spring: {coil: {from: 0 0 0 m, to: 1e300 0 0 m}}}\noutputs: {still: {image: {size: 16 9}}}\n"
    (tmp_path / "s.yaml").write_text(script)
    assert sceneql(tmp_path, "render", "s.yaml").startswith("made s.png\nrun ")


def test_no_folder_is_made_for_a_path_that_was_named(tmp_path):
    (tmp_path / "still.yaml").write_text(STILL)
    assert "there is no folder nowhere" in sceneql(tmp_path, "render", "still.yaml", "-o", "nowhere/x.png", code=1)
    assert not (tmp_path / "nowhere").exists()


def test_numbers_of_options_are_in_range(tmp_path):
    (tmp_path / "still.yaml").write_text(STILL)
    for options in (["bench", "--error", "-1"], ["stability", "--points", "0"]):
        assert "is not in the range" in sceneql(tmp_path, *options, "still.yaml", code=2)
    assert "'0' is no length above 0" in sceneql(tmp_path, "mesh", "--cell", "0", "still.yaml", code=2)


def test_render_sets_variants_and_names(tmp_path):
    (tmp_path / "still.yaml").write_text(STILL + "variants: {wide: {outputs.still.size: 64 18}}\n")
    assert "made still.png" in sceneql(tmp_path, "render", "still.yaml")
    sceneql(tmp_path, "render", "still.yaml", "--variant", "wide", "-o", "wide.png")
    sceneql(tmp_path, "render", "still.yaml", "--set", "outputs.still.size=16 18", "-o", "thin.png")
    from PIL import Image

    for name, width in (("still", 32), ("wide", 64), ("thin", 16)):
        with Image.open(tmp_path / f"{name}.png") as picture:
            assert picture.width == width
    assert not list(tmp_path.glob(".*.part*"))


def test_exit_codes_of_mistakes(tmp_path):
    (tmp_path / "bad.yaml").write_text("objects: {ball: {sphere: {radus: 1 m}}}\n")
    assert "did you mean `radius: 1 m`?" in sceneql(tmp_path, "check", "bad.yaml", code=3)
    sceneql(tmp_path, "check", "none.yaml", code=3)
    sceneql(tmp_path, "frobnicate", code=2)
    assert "did you mean 'blobby'" in sceneql(tmp_path, "words", "bloby", code=2)
    (tmp_path / "big.yaml").write_text("models: {net: {mass_spring: {lattice: {count: 10000 10000 10000}}}}\n")
    assert "big.yaml:1:" in sceneql(tmp_path, "check", "big.yaml", code=5)


def test_a_step_within_the_bound_runs_and_one_beyond_it_fails_where_it_is_written(tmp_path):
    (tmp_path / "in.yaml").write_text(SPRING.format(step=f"{0.95 * BOUND} s", end="200 s", solver="rk4", output=RECORD))
    sceneql(tmp_path, "render", "in.yaml")
    (tmp_path / "out.yaml").write_text(
        SPRING.format(step=f"{1.05 * BOUND} s", end="2000 s", solver="rk4", output=RECORD)
    )
    said = sceneql(tmp_path, "render", "out.yaml", code=1)
    assert "run-failed" in said
    assert "swing" in said
    assert "--> out.yaml:" in said
    assert not (tmp_path / "out.csv").exists()
    assert (tmp_path / "out.partial.csv").is_file()


def test_explain_tells_the_bound(tmp_path):
    (tmp_path / "s.yaml").write_text(SPRING.format(step="10 ms", end="1 s", solver="rk4", output=RECORD))
    (island,) = json.loads(sceneql(tmp_path, "explain", "s.yaml", "--json"))["islands"]
    assert island["step_bound"] == pytest.approx(BOUND, rel=0.01)
    said = sceneql(tmp_path, "explain", "s.yaml", "--set", "solvers.main={euler: {step: 10 ms}}")
    assert "no step is stable" in said
    assert f"{math.sqrt(1 + 0.1**2):.5f}"[:7] in said


def test_a_failed_film_keeps_its_frames(tmp_path):
    import av

    film = "film: {video: {size: 64 36, renderer: normals}}"
    (tmp_path / "f.yaml").write_text(SPRING.format(step="0.3 s", end="2000 s", solver="euler", output=film))
    said = sceneql(tmp_path, "render", "f.yaml", code=1)
    assert "kept f.partial.mp4" in said
    assert not (tmp_path / "f.mp4").exists()
    with av.open(tmp_path / "f.partial.mp4") as kept:
        assert sum(1 for _ in kept.decode(video=0)) > 10


def test_an_interrupted_film_keeps_its_frames(tmp_path):
    film = "film: {video: {size: 64 36, fps: 1000, renderer: normals}}"
    (tmp_path / "f.yaml").write_text(SPRING.format(step="1 ms", end="100 s", solver="rk4", output=film))
    process = subprocess.Popen(
        [sys.executable, "-m", "sceneql", "render", "f.yaml"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    while not list(tmp_path.glob(".f.part-*.mp4")) and process.poll() is None:
        time.sleep(0.05)
    time.sleep(1.0)
    os.kill(process.pid, signal.SIGINT)
    said = process.communicate(timeout=300)[1]
    assert process.returncode == 130, said
    assert "kept f.partial.mp4" in said
    assert not (tmp_path / "f.mp4").exists()


def test_an_interrupt_while_all_is_compiled_is_quiet_and_leaves_no_process(tmp_path):
    film = "film: {video: {size: 64 36}}"
    (tmp_path / "f.yaml").write_text(SPRING.format(step="1 ms", end="1 s", solver="rk4", output=film))
    process = subprocess.Popen(
        [sys.executable, "-m", "sceneql", "render", "f.yaml"], cwd=tmp_path, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "SCENEQL_CACHE": str(tmp_path / "cache")}, start_new_session=True,
    )  # fmt: skip
    while not list(tmp_path.glob("cache/**/*.nbc")) and process.poll() is None:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all of them
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 130, said
    assert "Traceback" not in said
    for _ in range(100):
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    raise AssertionError("a process goes on")


def test_new_writes_a_script_that_checks(tmp_path):
    sceneql(tmp_path, "new", "mine")
    assert "mine.yaml: ok" in sceneql(tmp_path, "check", "mine.yaml")
    assert json.loads((tmp_path / "sceneql.schema.json").read_text())["title"]
    assert "is there already" in sceneql(tmp_path, "new", "mine", code=1)


def test_every_word_has_its_page(tmp_path):
    catalogue = Catalogue()
    listing = sceneql(tmp_path, "words")
    from sceneql.report.manual import manual

    for family in catalogue.families:
        for word in catalogue.words(family):
            assert word in listing
            assert "fields:" in manual(catalogue, word)


def test_the_schema_knows_all_that_scenes_use():
    properties = schema(Catalogue())["properties"]
    definitions = schema(Catalogue())["$defs"]
    for path in SCENES.glob("*.yaml"):
        for section, entries in yaml.load(path.read_text(), yaml.BaseLoader).items():  # YAML 1.1 reads `on` as yes
            assert section in properties, (path, section)
            if section not in definitions:
                continue
            words = definitions[section]["anyOf"][1]["properties"]
            for entry in entries.values() if isinstance(entries, dict) else entries:
                if isinstance(entry, dict):
                    (word, fields), *_ = [(w, f) for w, f in entry.items() if w != "repeat"]
                    assert set(fields or {}) <= set(words[word]["properties"]), (path, word)


def test_a_name_that_ends_in_another_format_is_refused(tmp_path):
    film = "film: {video: {size: 64 36, renderer: normals}}"
    (tmp_path / "f.yaml").write_text(SPRING.format(step="1 ms", end="0.1 s", solver="rk4", output=film))
    said = sceneql(tmp_path, "render", "f.yaml", "-o", "film.txt", code=2)
    assert said.strip() == "error: 'film' is written as .mp4, which film.txt does not end in"
    assert [path.name for path in tmp_path.iterdir()] == ["f.yaml"]


def test_a_folder_that_is_named_gets_the_files(tmp_path):
    """It wrote `films.png` beside the folder."""
    (tmp_path / "still.yaml").write_text(STILL)
    assert f"made {Path('films') / 'still.png'}" in sceneql(tmp_path, "render", "still.yaml", "-o", "films/")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["films", "still.yaml"]
