"""Writing of files that are complete under their final name, or not there: written under a hidden name, then renamed.

The hidden name is unique to the process (machine, process number, random part), so that of several processes that make
one file each makes a complete one, and the last to finish wins. Remains of a killed process are removed by the next.
"""

from __future__ import annotations

import errno
import hashlib
import os
import platform
import re
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import BinaryIO

from sceneql.failure import Unsuitable

HIDDEN = re.compile(r"\..*\.part-([0-9a-f]{8})-([0-9]+)-[0-9a-f]{8}(\.[^.]*)?", re.DOTALL)
"""Pattern of hidden names: machine, process number on it, random part."""
LONGEST_STEM = 80
"""Largest number of bytes of a file's name in its hidden name."""
NUMBERS = r"\.[0-9]{4,}"
"""Pattern before the extension of files in a numbered row."""
ABANDONED = 7 * 86400.0
"""Age [s] at which a hidden file of another machine counts as abandoned."""
_in_the_making: set[str] = set()
"""Hidden names that this process has handed out and not yet renamed or removed."""


def beside(path: Path, mark: str) -> Path:
    """``film.mp4`` with mark ``partial`` is ``film.partial.mp4``."""
    return path.with_name(f"{path.stem}.{mark}{path.suffix}")


def hidden(path: Path) -> Path:
    """A hidden name, with the same extension, for a file in the making; end it by `finish` or `discard`."""
    stem = os.fsencode(path.stem)[:LONGEST_STEM].decode(errors="ignore")
    name = f".{stem}.part-{_machine()}-{os.getpid()}-{os.urandom(4).hex()}{path.suffix}"
    _in_the_making.add(name)
    return path.with_name(name)


def finish(made: Path, path: Path) -> None:
    """Give a file in the making its final name, after the disk has all of it. Raises OSError."""
    try:
        with made.open("rb") as stream:
            os.fsync(stream.fileno())
        made.replace(path)
    finally:
        discard(made)


def discard(made: Path) -> None:
    """Remove a file in the making, if it is there."""
    made.unlink(missing_ok=True)
    _in_the_making.discard(made.name)


@contextmanager
def whole(path: Path) -> Iterator[BinaryIO]:
    """Context manager: a binary file that appears as ``path`` if the block ends without exception, else not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    made = hidden(path)
    try:
        with made.open("xb") as stream:
            yield stream
        finish(made, path)
    except BaseException:
        discard(made)
        raise


def try_folder(folder: Path) -> None:
    """Make a folder if it is missing, and remove remains of killed processes.

    Raises OSError where nothing can be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    made = hidden(folder / "try")
    try:
        made.touch(exist_ok=False)
    finally:
        discard(made)
    sweep(folder)


def sweep(folder: Path) -> None:
    """Remove hidden files of ended processes, and old ones of other machines, whose processes are unknown."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            with suppress(OSError):
                if _left_behind(entry):
                    os.unlink(entry.path)


def _left_behind(entry: os.DirEntry[str]) -> bool:
    found = HIDDEN.fullmatch(entry.name)
    if found is None or entry.name in _in_the_making or not entry.is_file(follow_symlinks=False):
        return False
    if found[1] == _machine() and os.name == "posix":
        return int(found[2]) == os.getpid() or not _lives(int(found[2]))
    return time.time() - entry.stat(follow_symlinks=False).st_mtime > ABANDONED


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # another user's
        return True
    return True


@cache
def _machine() -> str:
    """Identifier of the machine, or container, within which process numbers are unique."""
    host, space = platform.node(), ""
    with suppress(OSError):
        space = os.readlink("/proc/self/ns/pid")
    return hashlib.sha256(f"{host} {space}".encode()).hexdigest()[:8]


def refuse_unwritable(path: Path, inputs: Iterable[str | Path] = (), marks: str = "") -> None:
    """Raise Unsuitable where a file cannot be made as ``path``, or must not, as it is one of the ``inputs``.

    This holds for its partial name too, and for files of a row, which have ``marks`` (a regular expression, as
    `NUMBERS`) before the extension.
    """
    unseen = hidden(path)
    for name in (path, beside(path, "partial"), unseen):
        try:
            name.lstat()
        except OSError as error:
            if error.errno == errno.ENAMETOOLONG:
                raise Unsuitable(f"the name {_short(path)} is too long for a file here") from None
    discard(unseen)
    if not marks and path.is_dir():
        raise Unsuitable(f"{path} is a folder")
    mine = re.compile(rf"{re.escape(path.stem)}({marks}|\.partial){re.escape(path.suffix)}", re.DOTALL)
    there = [Path(entry) for entry in _entries(path.parent) if mine.fullmatch(entry.name)]
    for read in map(Path, inputs if there else ()):
        for name in there:
            if _same(name, read):
                raise Unsuitable(f"{name} is read by the script: it would be written over")


def _entries(folder: Path) -> list[os.DirEntry[str]]:
    with suppress(OSError), os.scandir(folder) as entries:
        return list(entries)
    return []


def _same(one: Path, other: Path) -> bool:
    """Whether two paths are the same file, by links of any kind."""
    with suppress(OSError):
        return one.samefile(other)
    return False


def _short(path: Path) -> str:
    text = str(path)
    return text if len(text) <= 60 else f"{text[:30]}...{text[-20:]} of {len(os.fsencode(text))} bytes"
