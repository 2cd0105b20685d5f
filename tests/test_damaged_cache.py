"""A kernel cache that is damaged, full or not there costs time and a line, and never a run.

SCENEQL_LONG=1 has 500 damages in place of a few (in many runs: ten minutes), and two runs at once beside a
process that damages what they write.
"""

import errno
import os
import random
import shutil
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest

from sceneql.compiled import store
from sceneql.compiled.kernels import MODE
from sceneql.compiled.store import CacheTrouble, Store

SCRIPT = """
models: {ball: {particles: {list: {a: {mass: 1 kg, position: 0 0 0 m}}}}}
forces: [gravity]
solvers: {main: {rk4: {step: 10 ms}}}
clock: {end: 1 s}
outputs: {data: {record: {of: [ball.a.position]}}}
"""
MADE_ANEW = "warning: damaged files of the kernel cache {} are made anew"
UNWRITABLE = "warning: the kernel cache {} cannot be written ({}): this run keeps what it compiles in a temporary"
LONG = "SCENEQL_LONG" in os.environ
compiled = pytest.mark.skipif(MODE == "uncompiled", reason="nothing is compiled")


def flip(data, dice):
    """One bit."""
    at = dice.randrange(len(data))
    return data[:at] + bytes([data[at] ^ (1 << dice.randrange(8))]) + data[at + 1 :]


DAMAGES = {
    "a flipped bit": flip,
    "truncated": lambda data, dice: data[: dice.randrange(len(data))],
    "empty": lambda data, dice: b"",
    "garbage appended": lambda data, dice: data + dice.randbytes(dice.randint(1, 100)),
    "zeros": lambda data, dice: bytes(len(data)),
}


@pytest.fixture
def kept(tmp_path):
    """A store, and the path of a file in it."""
    made = Store(tmp_path / "cache" / "numba")
    made.write("module/kernel", b"some code")
    return made, tmp_path / "cache" / "numba" / "module" / "kernel"


def told(capsys):
    """The lines on standard error so far."""
    return capsys.readouterr().err.splitlines()


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_data_are_not_read_and_are_told_once_when_made_anew(kept, capsys, damage):
    cache, path = kept
    assert cache.read("module/kernel") == b"some code"
    path.write_bytes(DAMAGES[damage](path.read_bytes(), random.Random(1)))
    assert cache.read("module/kernel") is None
    assert told(capsys) == []
    for _ in range(2):
        cache.write("module/kernel", b"some code")
    assert told(capsys) == [MADE_ANEW.format(cache.folder)]
    assert cache.read("module/kernel") == b"some code"


def test_a_file_with_the_contents_of_another_is_damaged(kept):
    cache, path = kept
    cache.write("module/other", b"other code")
    shutil.copy(path, path.with_name("other"))
    assert cache.read("module/other") is None


def test_folders_and_files_in_the_place_of_each_other_make_way(kept, capsys):
    cache, path = kept
    path.unlink()
    path.mkdir()
    (path / "deep").mkdir()
    assert cache.read("module/kernel") is None
    cache.write("module/kernel", b"some code")
    assert told(capsys) == [MADE_ANEW.format(cache.folder)]
    shutil.rmtree(path.parent)
    path.parent.write_text("a file")
    assert cache.read("module/kernel") is None
    cache.write("module/kernel", b"some code")
    assert cache.read("module/kernel") == b"some code"


def test_a_file_of_another_user_is_not_loaded(kept, monkeypatch):
    cache, path = kept
    if os.geteuid() == 0:  # whose files all may load
        os.chown(path, 1, 1)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: 0)
    assert cache.read("module/kernel") is None


def test_a_second_process_leaves_what_is_to_tell_to_the_first(kept, capsys):
    cache, path = kept
    cache.second = True
    path.write_bytes(b"")
    with pytest.raises(CacheTrouble):
        cache.read("module/kernel")
    shutil.rmtree(cache.folder.parent)
    cache.folder.parent.write_text("a file")
    with pytest.raises(CacheTrouble):
        cache.write("module/kernel", b"some code")
    assert told(capsys) == []


def test_the_folders_are_for_their_user_alone(kept, tmp_path):
    assert {(tmp_path / "cache" / part).stat().st_mode & 0o777 for part in ("", "numba", "numba/module")} == {0o700}


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_full_disk_is_told_and_a_temporary_folder_is_used(kept, capsys, monkeypatch, tmp_path, step):
    cache, path = kept
    home = cache.folder

    def full(*where):
        if step == "fsync" or home in Path(where[1]).parents:
            raise OSError(errno.ENOSPC, "No space left on device")
        return replace(*where)

    replace = os.replace
    monkeypatch.setattr(store, "mkdtemp", lambda prefix: str(tmp_path / prefix))
    monkeypatch.setattr(os, step, full)
    for name in ("module/second", "module/third"):
        cache.write(name, name.encode())
    (line,) = told(capsys)
    assert line.startswith(UNWRITABLE.format(home, "No space left on device"))
    assert "SCENEQL_CACHE" in line
    assert cache.read("module/kernel") == b"some code"
    assert cache.read("module/third") == (b"module/third" if step == "replace" else None)
    assert [one.name for one in path.parent.iterdir()] == ["kernel"]


def test_generated_modules_run_without_their_files(monkeypatch, capsys):
    from sceneql.compiled import generated, kernels

    def full(prefix):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(kernels, "CACHE", Store(None))
    monkeypatch.setattr(store, "mkdtemp", full)
    name = generated.write("told", "def answer():\n    return 42\n")
    assert generated.function(f"{name}:answer")() == 42
    assert not Path(generated.load(name).__file__).exists()
    assert "(there is no home folder)" in capsys.readouterr().err


def run(folder, cache, script="scene.yaml", **more):
    """Render the scene in a new process; its table and what it said, but that it compiles, as a slow machine tells."""
    environment = {**os.environ, "SCENEQL_CACHE": str(cache), "SCENEQL_THREADS": "2", **more}
    output = folder / f"{cache.name}{threading.get_ident()}.csv"
    command = [sys.executable, "-m", "sceneql", "render", str(folder / script), "-o", str(output)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return output.read_bytes(), [line for line in done.stderr.splitlines() if line != "scene: compiling"]


@pytest.fixture(scope="module")
def warm(tmp_path_factory):
    """A folder with the scene and a cache of all that it needs; its table."""
    folder = tmp_path_factory.mktemp("warm")
    (folder / "scene.yaml").write_text(SCRIPT)
    table, said = run(folder, folder / "cache")
    assert said == []
    return folder, table


def files(cache):
    """Files that a run of the scene loads, but for one emptied before that it loads where others are compiled alone."""
    return sorted(path for path in cache.rglob("*") if path.suffix in (".nbc", ".py") and path.stat().st_size)


def harm(paths, dice, count):
    """Damage this many of the files, each otherwise; then marks and locks. The number of files that were damaged."""
    chosen = dice.sample(paths, count)
    before = {path: path.read_bytes() for path in paths}
    for path in chosen:
        how = dice.choice([*DAMAGES, "another's contents", "a folder", "a dangling link"])
        if how == "another's contents":
            path.write_bytes(before[dice.choice([one for one in paths if one != path])])
        elif how in DAMAGES:
            path.write_bytes(DAMAGES[how](before[path], dice))
        else:
            path.unlink()
            if how == "a folder":
                path.mkdir()
            else:
                path.symlink_to(path)
    return sum(not path.is_file() or path.read_bytes() != before[path] for path in chosen)


def harm_the_rest(cache, dice, count):
    """Damage marks and locks, and delete files: none of it is told, since nothing that is there is wrong."""
    for path in dice.sample(sorted(path for path in cache.rglob("*") if path.is_file()), count):
        if path.suffix in (".lock", ".compiled") and dice.random() < 0.7:
            if dice.random() < 0.5:
                path.write_bytes(dice.randbytes(30))
            else:
                path.unlink()
                path.mkdir()
        else:
            path.unlink()


@compiled
def test_random_damage_of_the_cache_is_mended_by_the_next_run(warm):
    folder, table = warm
    dice = random.Random(19)
    damages = 0
    while damages < (500 if LONG else 6):
        cache = folder / "cache"
        damages += harm(files(cache), dice, 6)
        harm_the_rest(cache, dice, 3)
        found, said = run(folder, cache)
        assert found == table
        assert said == [MADE_ANEW.format(next((cache / "sceneql").iterdir()))]
        assert run(folder, cache) == (table, [])


@compiled
def test_a_cache_that_cannot_be_written_is_told_and_leaves_nothing_behind(warm, tmp_path):
    folder, table = warm
    (tmp_path / "file").write_text("")
    (tmp_path / "temporary").mkdir()
    found, (line,) = run(folder, tmp_path / "file", TMPDIR=str(tmp_path / "temporary"))
    assert found == table
    assert line.startswith("warning: the kernel cache ")
    assert "(Not a directory)" in line
    assert list((tmp_path / "temporary").iterdir()) == []


@compiled
@pytest.mark.skipif(not LONG, reason="it compiles all anew several times")
@pytest.mark.parametrize("seed", range(10))
def test_two_runs_at_once_go_well_while_another_process_damages_what_they_write(warm, tmp_path, seed):
    folder, table = warm
    cache, dice = tmp_path / "cache", random.Random(seed)
    with ThreadPoolExecutor(2) as pool:
        runs = [pool.submit(run, folder, cache) for _ in range(2)]
        while not all(one.done() for one in runs):
            for path in [path for path in cache.rglob("*") if path.is_file() and dice.random() < 0.01]:
                with suppress(FileNotFoundError):  # just replaced
                    path.write_bytes(flip(path.read_bytes() or b"x", dice))
            time.sleep(0.02)
        assert [one.result()[0] for one in runs] == [table, table]


@pytest.mark.parametrize("asked", ["x", "0", "-3", "1e9", "1000000", "1_0"])
def test_threads_that_are_no_number_of_threads_are_refused_by_every_command(monkeypatch, asked):
    from click.testing import CliRunner

    from sceneql.cli import cli
    from sceneql.failure import Unsuitable

    monkeypatch.setenv("SCENEQL_THREADS", asked)
    error = CliRunner().invoke(cli, ["words"]).exception
    assert isinstance(error, Unsuitable)
    assert str(error).startswith(f"SCENEQL_THREADS is '{asked}': it may be a whole number")
