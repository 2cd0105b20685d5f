"""What is made is whole or not there, whoever writes beside and whatever ends the program; and what ends it is told.

SCENEQL_KILLS=N kills N renders and pairs up N/5: `SCENEQL_KILLS=200 python -m pytest tests/test_nothing_lost.py`.
"""

import errno
import os
import random
import resource
import signal
import subprocess
import sys
import time
import tracemalloc
from contextlib import suppress
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

import test_program
from renderers.encoders import mp4
from sceneql import cli, exits, files, interrupts, pipeline
from sceneql.compiled.kernels import MODE
from sceneql.failure import OutOfMemory, RunFailure, Unsuitable, failing_as, starved
from sceneql.language.include import read_source

KILLS = int(os.environ.get("SCENEQL_KILLS", "2"))
FILM = """
clock: {end: 0.5 s, fps: 60}
objects: {ball: {sphere: {radius: 0.2 m, position: [0 m, 1 m + time*1 m/s, 0 m]}}}
outputs:
  film: {video: {size: 64 36, renderer: normals}}
  data: {record: {of: [time]}}
"""
STILL = test_program.STILL
PROGRAM = [sys.executable, "-m", "sceneql"]


def started(folder, *args, **options):
    return subprocess.Popen(
        [*PROGRAM, *args], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
    )


def frames(path):
    with av.open(str(path)) as film:
        return sum(1 for _ in film.decode(video=0))


def hidden_files(folder):
    return [path.name for path in folder.iterdir() if path.name.startswith(".")]


def limited(kind, limit):
    return lambda: resource.setrlimit(kind, (limit, limit))


class Lock:
    """One written in Python, as LLVM's is, with a signal between its lines."""

    taken = 0

    def __init__(self, struck):
        self.struck = struck

    def __enter__(self):
        self.taken += 1
        if self.struck == "enter":
            signal.raise_signal(signal.SIGINT)

    def __exit__(self, *_):
        if self.struck == "exit":
            signal.raise_signal(signal.SIGINT)
        self.taken -= 1


@pytest.mark.parametrize("struck", ["enter", "exit"])
def test_a_signal_while_a_lock_is_taken_or_given_back_leaves_it_free(struck):
    """It stayed taken, and the threads that compile waited for ever."""
    lock = Lock(struck)
    with pytest.raises(KeyboardInterrupt), interrupts.raised():  # noqa: PT012
        with lock:
            pass
        time.sleep(5.0)
    assert lock.taken == 0


# --- several processes ---


def test_of_processes_that_render_one_film_each_makes_a_whole_one(tmp_path):
    (tmp_path / "f.yaml").write_text(FILM)
    for _ in range(max(1, KILLS // 5)):
        pair = [started(tmp_path, "render", "f.yaml") for _ in range(2)]
        for process in pair:
            said = process.communicate(timeout=300)
            assert process.returncode == 0, said
        assert frames(tmp_path / "f.film.mp4") == 30
        assert not hidden_files(tmp_path)


def test_what_is_killed_leaves_nothing_torn_and_the_next_run_nothing_at_all(tmp_path):
    (tmp_path / "f.yaml").write_text(FILM)
    start = time.monotonic()
    started(tmp_path, "render", "f.yaml").communicate(timeout=300)
    whole, chance = time.monotonic() - start, random.Random(7)
    for _ in range(KILLS):
        number = chance.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
        process = started(tmp_path, "render", "f.yaml", start_new_session=True)
        with suppress(subprocess.TimeoutExpired):
            process.wait(chance.uniform(0.0, 1.0) * whole)
        process.send_signal(number)
        said = process.communicate(timeout=60)[1]
        if "Traceback" in said:  # of Python itself, before it reads a line of ours
            assert number == signal.SIGINT
            assert str(Path(cli.__file__).parent) not in said
        else:
            assert process.returncode in (0, -number, 128 + number), said
        for name, most in (("film", 30), ("film.partial", 30)):
            if (path := tmp_path / f"f.{name}.mp4").exists():
                assert 0 < frames(path) <= most
        with pytest.raises(ProcessLookupError):
            _wait_for_the_end_of(process.pid)
    started(tmp_path, "render", "f.yaml").communicate(timeout=300)
    assert not hidden_files(tmp_path)


def _wait_for_the_end_of(group):
    for _ in range(100):
        os.killpg(group, 0)
        time.sleep(0.05)


def test_hidden_files_of_the_dead_are_removed_and_no_others(tmp_path):
    mine = files.hidden(tmp_path / "film.mp4")
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    here = mine.name.split("-")[1]
    left = {
        "dead": f".film.part-{here}-{dead.pid}-00000000.mp4",
        "before": f".film.part-{here}-{os.getpid()}-00000000.mp4",  # of a process with our number, as in containers
        "living": f".film.part-{here}-{os.getppid()}-00000000.mp4",
        "elsewhere": f".film.part-00000000-{dead.pid}-00000000.mp4",
        "abandoned": f".film.part-00000000-{dead.pid}-00000001.mp4",
        "theirs": ".film.part.mp4",
    }
    for name in (mine.name, *left.values()):
        (tmp_path / name).touch()
    os.utime(tmp_path / left["abandoned"], (0, 0))
    files.try_folder(tmp_path)
    expected = [mine.name, *(left[name] for name in ("living", "elsewhere", "theirs"))]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(expected)
    files.discard(mine)


def test_the_process_that_compiles_beside_ends_with_a_killed_parent(tmp_path):
    code = (
        "import time; from sceneql.compiled import compile_beside as beside; pipe = beside._beside();"
        "pipe.write('slow /dev/null\\n'); pipe.flush(); print('up', flush=True); time.sleep(60)"
    )
    (tmp_path / "slow.py").write_text("while True: pass\n")  # compiling that takes long
    parent = subprocess.Popen(
        [sys.executable, "-c", code], cwd=tmp_path, stdout=subprocess.PIPE, start_new_session=True,
        env={**os.environ, "PYTHONPATH": f"{Path(cli.__file__).parent.parent}:{tmp_path}"},
    )  # fmt: skip
    assert parent.stdout.readline() == b"up\n"
    os.kill(parent.pid, signal.SIGKILL)
    parent.communicate()
    with pytest.raises(ProcessLookupError):
        _wait_for_the_end_of(parent.pid)


# --- signals and what is no signal ---


def test_a_file_that_ends_too_soon_is_no_ctrl_c(monkeypatch, capsys):
    def broken(*args, **options):
        raise EOFError("Ran out of input")

    monkeypatch.setattr(pipeline, "load", broken)
    monkeypatch.setattr(sys, "argv", ["sceneql", "check", "s.yaml"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == exits.RUN_FAILED
    assert capsys.readouterr().err.strip() == "error: a file ends too soon: Ran out of input"
    with pytest.raises(RunFailure, match="at 1 s, ball: a file ends too soon"), failing_as("ball", 1.0, None):
        raise EOFError


def test_a_signal_waits_for_what_is_being_finished():
    done = []
    with pytest.raises(KeyboardInterrupt), interrupts.raised() as pressed, interrupts.held():  # noqa: PT012
        os.kill(os.getpid(), signal.SIGTERM)
        assert pressed()
        done.append("finished")
    assert done
    assert interrupts.exit_code() == 128 + signal.SIGTERM


# --- memory and disk ---


def test_a_want_of_memory_tells_where_and_what_takes_less(tmp_path):
    (tmp_path / "s.yaml").write_text(STILL.replace("size: 32 18", "size: 16000 16000, renderer: normals"))
    process = started(tmp_path, "render", "s.yaml", preexec_fn=limited(resource.RLIMIT_AS, 2_000_000_000))
    said = process.communicate(timeout=300)[1]
    assert process.returncode == exits.LIMIT_REFUSED, said
    assert said.startswith("error[out-of-memory]: at 0 s, still.renderer: out of memory for 2.86 GiB")
    assert "when making the frame" in said
    assert "--> s.yaml:" in said
    assert "help: a smaller `size` of 'still' takes less" in said


def test_a_script_takes_no_more_memory_than_it_is_long(tmp_path):
    """It took 32 MB, and so ran out of memory where there was enough."""
    (tmp_path / "s.yaml").write_text(STILL)
    tracemalloc.start()
    read_source(tmp_path / "s.yaml")
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 1_000_000


@pytest.mark.skipif(MODE == "uncompiled", reason="nothing is compiled")
def test_a_want_of_memory_for_the_compiler_is_told_before_it_ends_the_process(tmp_path):
    (tmp_path / "f.yaml").write_text(FILM.replace("normals", "trace"))
    limit = (
        "import resource, sys; from sceneql import cli; from sceneql.compiled import kernels;"
        "now = resource.getpagesize()*int(open('/proc/self/statm').read().split()[0]);"
        "resource.setrlimit(resource.RLIMIT_AS, (now + 100*2**20,)*2);"
        "sys.argv = ['sceneql', 'render', 'f.yaml']; cli.main()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", limit], cwd=tmp_path, stderr=subprocess.PIPE, text=True,
        env={**os.environ, "SCENEQL_CACHE": str(tmp_path / "cache"), "SCENEQL_THREADS": "1"},
    )  # fmt: skip
    said = process.communicate(timeout=300)[1]
    assert process.returncode == exits.LIMIT_REFUSED, said
    assert said.startswith("error[out-of-memory]: at 0 s, film: out of memory for 160 MiB to compile, when ")
    assert "--> f.yaml:" in said


def test_a_library_that_would_end_the_process_for_want_of_memory_is_not_loaded(tmp_path):
    (tmp_path / "f.yaml").write_text(FILM)
    process = started(tmp_path, "render", "f.yaml", preexec_fn=limited(resource.RLIMIT_AS, 150 * 2**20))
    said = process.communicate(timeout=300)[1]
    assert process.returncode == exits.LIMIT_REFUSED, said
    assert said.startswith("error[out-of-memory]: at 0 s, film, data: out of memory for ")
    assert "MiB to load numpy, when starting the run\n --> f.yaml:5:3" in said


@pytest.mark.parametrize(
    ("library", "product"), [("numpy", "a @ a"), ("scipy.linalg", "scipy.linalg.blas.dgemm(1.0, a, a)")]
)
def test_openblas_has_its_memory_from_its_import_on(library, product):
    """It took it at the first product, and ended the process with exit code 1 where none was left."""
    run = (
        "import resource; from sceneql import room; room.ask_before_imports();"
        f"import numpy, {library}; a = numpy.arange(90000.0).reshape(300, 300) % 7;"
        "now = resource.getpagesize()*int(open('/proc/self/statm').read().split()[0]);"
        "resource.setrlimit(resource.RLIMIT_AS, (now + 12*2**20,)*2);"
        f"print(({product})[0].shape)"
    )
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
    done = subprocess.run([sys.executable, "-c", run], capture_output=True, text=True, env=environment, timeout=60)
    assert done.returncode == 0, done.stderr


def test_what_libraries_make_of_a_want_of_memory_is_one():
    assert starved(MemoryError())
    assert starved(ImportError("libavfilter.so: failed to map segment from shared object"))
    assert starved(OSError(errno.ENOMEM, "Cannot allocate memory"))
    plain = ImportError("The `pyav` plugin is not installed")
    assert not starved(plain)
    plain.__context__ = MemoryError()
    assert starved(plain)
    with pytest.raises(OutOfMemory, match="at 2 s, net: out of memory"), failing_as("net", 2.0, None):
        raise MemoryError


def test_a_full_disk_is_told_in_a_line(tmp_path):
    (tmp_path / "f.yaml").write_text(FILM.replace("normals", "normals, quality: 0"))
    process = started(tmp_path, "render", "f.yaml", preexec_fn=limited(resource.RLIMIT_FSIZE, 4096))
    said = process.communicate(timeout=300)[1]
    assert process.returncode == exits.RUN_FAILED
    assert said.splitlines() == [
        "error: [Errno 27] File too large",
        "kept f.data.partial.csv",
        "nothing of 'film' could be kept",
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["f.data.partial.csv", "f.yaml"]


def test_a_film_stops_while_the_disk_has_room_to_finish_it(tmp_path, monkeypatch):
    film = mp4.Writer(tmp_path / "film.mp4", size=(64, 36), rate=30.0, quality=17, comment="")
    picture = np.zeros((36, 64, 3), dtype=np.uint8)
    for _ in range(150):
        film.write(picture)
    usage = mp4.shutil.disk_usage(tmp_path)
    monkeypatch.setattr(mp4.shutil, "disk_usage", lambda folder: usage._replace(free=60_000))
    with pytest.raises(OSError, match="No space left"):
        film.write(picture)
    assert film.abort() == [tmp_path / "film.partial.mp4"]
    assert frames(tmp_path / "film.partial.mp4") == 150


@pytest.mark.parametrize("room", [80_000, 130_000])
def test_of_a_disk_that_is_full_after_few_frames_these_are_kept(tmp_path, monkeypatch, room):
    film = mp4.Writer(tmp_path / "film.mp4", size=(128, 72), rate=30.0, quality=17, comment="")
    usage, draw = mp4.shutil.disk_usage(tmp_path), np.random.default_rng(1)

    def left(folder):
        return usage._replace(free=room - sum(path.stat().st_size for path in tmp_path.iterdir()))

    monkeypatch.setattr(mp4.shutil, "disk_usage", left)

    def draws():
        for _ in range(2 * mp4.AT_ONCE):
            film.write(np.kron(draw.integers(0, 60, (9, 16, 3)), np.ones((8, 8, 1))).astype(np.uint8))

    with pytest.raises(OSError, match="No space left"):
        draws()
    assert film.abort() == [tmp_path / "film.partial.mp4"]
    assert frames(tmp_path / "film.partial.mp4") == film.frames > 10
    assert left(tmp_path).free > 0


# --- names that are refused ---


def test_names_that_no_file_can_have_are_refused_before_the_run(tmp_path):
    (tmp_path / "s.yaml").write_text(STILL)
    for arguments in (
        ("render", "s.yaml", "-o", f"{'x' * 250}.png"),
        ("render", "s.yaml", "-o", f"{'x/' * 2100}x.png"),
        ("mesh", "s.yaml", "--object", "ball", "-o", f"{'x' * 250}.ply"),
        ("new", "x" * 250),
    ):
        assert "is too long for a file here" in test_program.sceneql(tmp_path, *arguments, code=2)
    (tmp_path / "folder.png").mkdir()
    assert "is a folder" in test_program.sceneql(tmp_path, "render", "s.yaml", "-o", "folder.png", code=2)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.png", "s.yaml"]


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """A scene that reads a script, a mesh and a picture, and the texts of them all."""
    monkeypatch.chdir(tmp_path)
    Path("cube.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    Image.new("L", (8, 8)).save("ink.0003.png")
    Path("more.csv").write_text("objects: {part: {mesh: {file: cube.obj}}}\n")
    Path("s.yaml").write_text(STILL + "include: [more.csv]\n")
    return {path: path.read_bytes() for path in tmp_path.iterdir()}


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (("mesh", "s.yaml", "--object", "ball", "-o", "cube.obj"), "cube.obj"),
        (("mesh", "s.yaml", "--object", "ball", "-o", "soft.obj"), "soft.obj"),
        (("mesh", "s.yaml", "--object", "ball", "-o", "hard.obj"), "hard.obj"),
        (("render", "s.yaml", "--set", "outputs={d: {record: {of: [time]}}}", "-o", "more.csv"), "more.csv"),
        (("bench", "s.yaml", "-o", "more"), "more.csv"),
    ],
)
def test_an_output_that_is_an_input_is_refused(scene, arguments, name):
    Path("soft.obj").symlink_to("cube.obj")
    os.link("cube.obj", "hard.obj")
    if arguments[0] == "bench":
        Path("s.yaml").write_text(Path("s.yaml").read_text() + test_program.SPRING.partition("models:")[1] + SPRING)
        scene[Path.cwd() / "s.yaml"] = Path("s.yaml").read_bytes()
    said = test_program.sceneql(Path(), *arguments, code=2)
    assert said.strip() == f"error: {name} is read by the script: it would be written over"
    assert {path: path.read_bytes() for path in scene} == scene


SPRING = """
  swing:
    mass_spring:
      masses: {wall: {position: 0 0 0 m, fixed: yes}, bob: {position: 1.2 0 0 m, mass: 1 kg}}
      springs: [{between: [wall, bob], rest: 0 m, stiffness: 100 N/m}]
"""


def test_files_in_a_row_and_partial_names_are_refused_too(tmp_path):
    for name in ("row.0003.png", "row.partial.png", "row.mask.png", "row.png"):
        (tmp_path / name).touch()
    for name in ("row.0003.png", "row.partial.png"):
        with pytest.raises(Unsuitable, match="is read by the script"):
            files.refuse_unwritable(tmp_path / "row.png", [tmp_path / name], marks=files.NUMBERS)
    for name in ("row.mask.png", "row.png"):
        files.refuse_unwritable(tmp_path / "row.png", [tmp_path / name], marks=files.NUMBERS)
