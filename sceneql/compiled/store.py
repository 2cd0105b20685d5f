"""The folder of compiled code: its files are whole, carry a checksum, and are made anew where they are damaged.

Where nothing can be written, the run goes on with a temporary folder. Checksums find damage by disks, memory and killed
programs. They are no guard against someone who may write into the user's own cache: he could as well change the
program. Files of other users are therefore not read, since loading compiled code runs it.
"""

from __future__ import annotations

import atexit
import errno
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from hashlib import blake2b
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp, mkstemp
from typing import Any

DIGEST = 16
"""Bytes of a checksum, with which a file begins."""

fcntl: Any = import_module("fcntl") if find_spec("fcntl") else None  # not on Windows


class CacheTrouble(Exception):
    """The second process meets damage, or cannot write: it ends, and the first tells and mends."""


def _checksum(name: str, data: bytes | memoryview) -> bytes:
    """Of a file's name, too: a file that has another's contents is damaged."""
    return blake2b(data, digest_size=DIGEST, key=blake2b(name.encode()).digest()).digest()


def _contents(path: str) -> bytes | None:
    """What stands in a file; None where there is none. Raises OSError, also for a file of another user."""
    try:
        with open(path, "rb", buffering=0) as file:
            owner = os.fstat(file.fileno()).st_uid
            if sys.platform != "win32" and owner not in (os.geteuid(), 0):
                raise PermissionError(errno.EPERM, "a file of another user", path)
            return file.read()
    except FileNotFoundError:
        return None


class Store:
    """Files below ``folder``, which is made when the first is written, by names with ``/`` between folders.

    Where ``folder`` is None, there is no place for any: a temporary folder is used from the first on.
    """

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        """Where files are written; later perhaps a temporary folder, or None where that cannot be written either."""
        self.second = False
        """Whether this is the second process (compile_beside), which raises CacheTrouble where the first one tells."""
        self._home = folder
        self._places = [] if folder is None else [str(folder)]
        self._damaged: set[str] = set()
        self._has_left = self._has_told = False

    def path(self, name: str) -> Path:
        """Where the file of a name stands, for debuggers; it may not be there."""
        return (self.folder or Path("unwritten")) / name

    def has(self, name: str) -> bool:
        """Whether anything stands under a name."""
        return any(os.path.exists(f"{place}/{name}") for place in self._places)

    def read(self, name: str) -> memoryview | None:
        """What was written under a name; None where nothing was, or where it is damaged."""
        for place in self._places:
            try:
                data = _contents(f"{place}/{name}")
            except OSError:
                data = b""
            if data is not None:
                kept = memoryview(data)[DIGEST:]
                if _checksum(name, kept) == data[:DIGEST]:
                    return kept
                self._note_damage(name)
        return None

    def write(self, name: str, data: bytes) -> None:
        """Keep data under a name, with their checksum."""
        self._keep(name, _checksum(name, data) + data)

    def write_text(self, name: str, data: bytes) -> None:
        """Keep a file without a checksum, for people to read, unless it stands there already."""
        for place in self._places:
            try:
                found = _contents(f"{place}/{name}")
            except OSError:
                found = b""
            if found == data:
                return
            if found is not None:
                self._note_damage(name)
        self._keep(name, data)

    def mark(self, name: str) -> None:
        """Keep an empty file: that it is there says all."""
        self._keep(name, b"")

    def prove(self) -> None:
        """Go over to a temporary folder now where nothing can be written, and not when the first file is."""
        self._keep("proof", bytes(65536))
        with suppress(OSError):
            self.path("proof").unlink()

    @contextmanager
    def alone(self, name: str) -> Iterator[None]:
        """Let one process at a time make a file, where the system has locks: the next one loads the result."""
        with ExitStack() as held:
            if fcntl is not None and self.folder is not None:
                with suppress(OSError):  # without locks both make it, and what is written last is kept
                    path = self.folder / f"{name}.lock"
                    _make_folder(path.parent)
                    fcntl.flock(held.enter_context(path.open("w")), fcntl.LOCK_EX)
            yield

    def _note_damage(self, name: str) -> None:
        if self.second:
            raise CacheTrouble
        self._damaged.add(name)

    def _keep(self, name: str, data: bytes) -> None:
        if self.folder is None and not self._has_left:
            self._leave("there is no home folder")
        while self.folder is not None:
            try:
                _put(self.folder, name, data)
            except OSError as error:
                self._leave(error.strerror or str(error))
                continue
            if name in self._damaged and self.folder == self._home and not self._has_told:
                self._has_told = True
                _say(f"damaged files of the kernel cache {self.folder} are made anew")
            return

    def _leave(self, why: str) -> None:
        """Go over to a temporary folder; from there to none."""
        if self.second:
            raise CacheTrouble
        self.folder = None
        if self._has_left:
            return
        self._has_left = True
        _say(
            f"the kernel cache{f' {self._home}' if self._home else ''} cannot be written ({why}): this run keeps what"
            " it compiles in a temporary folder; SCENEQL_CACHE=FOLDER names another place"
        )
        with suppress(OSError):
            self.folder = Path(mkdtemp(prefix="sceneql-"))
            atexit.register(rmtree, self.folder, ignore_errors=True)
            self._places.append(str(self.folder))


def _put(root: Path, name: str, data: bytes) -> None:
    """Write a file that appears whole or not at all; what stands in its way is removed. Raises OSError."""
    path = root / name
    try:
        _write(path, data)
    except (NotADirectoryError, IsADirectoryError):
        for folder in reversed([one for one in path.parents if one.is_relative_to(root)]):
            if os.path.lexists(folder) and not folder.is_dir():
                folder.unlink()
        if path.is_dir():
            rmtree(path)
        _write(path, data)


def _write(path: Path, data: bytes) -> None:
    _make_folder(path.parent)
    handle, partial = mkstemp(dir=path.parent, suffix=".partial")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(partial)
        raise


def _make_folder(path: Path) -> None:
    """Make a folder, and those that it stands in, for this user alone."""
    if not path.is_dir():
        _make_folder(path.parent)
        with suppress(FileExistsError):  # made by another process meanwhile; or a file, of which the next step tells
            path.mkdir(mode=0o700)


def _say(what: str) -> None:
    print(f"warning: {what}", file=sys.stderr)
