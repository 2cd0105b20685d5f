"""png: one picture, or a numbered sequence; imports no video library."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from sceneql.files import whole

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray


FAST = 2
"""Largest level of compression for which all rows get the same filter: a choice takes longer than the compression."""


class Writer:
    """Writer of ``name.png``, or of ``name.0000.png``, ``name.0001.png``, ...; every file is complete when it appears.

    With more than one thread the pictures of a sequence are encoded in the background, as many at once as there are
    threads: each also waits for the disk. A picture must not change after ``write``, and an error is raised by a later
    call or at the end.
    """

    def __init__(self, path: Path, *, numbered: bool, comment: str, compression: int = 6) -> None:
        """``compression``: level of zlib (RFC 1950), from 0 (none) to 9."""
        self.path, self.numbered, self.comment, self.compression = path, numbered, comment, compression
        self.made: list[Path] = []
        self._count = 0
        self._beside: ThreadPoolExecutor | None = None
        self._underway: deque[tuple[Path, Future[None]]] = deque()

    def write(self, picture: NDArray[uint8]) -> None:
        """Add a picture (h, w, 3). Raises the error of one before, if it failed."""
        from sceneql.compiled.kernels import thread_count

        threads = thread_count()
        self._settle(threads - 1)
        path = self.path.with_name(f"{self.path.stem}.{self._count:04d}.png") if self.numbered else self.path
        self._count += 1
        if self.numbered and threads > 1:
            self._beside = self._beside or ThreadPoolExecutor(threads, thread_name_prefix="png")
            self._underway.append((path, self._beside.submit(self._save, picture, path)))
        else:
            self._save(picture, path)
            self.made.append(path)

    def close(self) -> list[Path]:
        """Wait for the last pictures; returns the files made, in order. Raises their first error."""
        try:
            self._settle()
        finally:
            self._end()
        return self.made

    def abort(self) -> list[Path]:
        """Stop; returns the files made, all complete."""
        while self._underway:
            with suppress(Exception):  # the error that ended the run is reported instead
                self._settle()
        self._end()
        return self.made

    def _save(self, picture: NDArray[uint8], path: Path) -> None:
        with whole(path) as stream:
            if self.compression <= FAST:
                stream.write(by_left(picture, self.comment, self.compression))
            else:
                from PIL import Image, PngImagePlugin

                notes = PngImagePlugin.PngInfo()
                notes.add_text("Comment", self.comment)
                Image.fromarray(picture).save(stream, "png", pnginfo=notes, compress_level=self.compression)

    def _settle(self, most: int = 0) -> None:
        """Wait until at most so many pictures are under way. Raises the error of one that failed, only once."""
        while len(self._underway) > most or (self._underway and self._underway[0][1].done()):
            path, saved = self._underway.popleft()
            saved.result()
            self.made.append(path)

    def _end(self) -> None:
        if self._beside is not None:
            self._beside.shutdown()
            self._beside = None


def by_left(picture: NDArray[uint8], comment: str, compression: int) -> bytes:
    """PNG file (ISO/IEC 15948:2004) of a picture (h, w, 3), all rows with filter 1: differences from the left."""
    import zlib

    import numpy as np

    height, width, channels = picture.shape
    rows = np.ones((height, 1 + channels * width), dtype=np.uint8)  # each row begins with its filter type
    flat = picture.reshape(height, -1)
    rows[:, 1 : 1 + channels] = flat[:, :channels]
    np.subtract(flat[:, channels:], flat[:, :-channels], out=rows[:, 1 + channels :])

    def chunk(kind: bytes, data: bytes) -> bytes:
        return len(data).to_bytes(4, "big") + kind + data + zlib.crc32(kind + data).to_bytes(4, "big")

    head = width.to_bytes(4, "big") + height.to_bytes(4, "big") + bytes((8, 2, 0, 0, 0))  # 8 bits, RGB
    return b"".join(
        (
            b"\x89PNG\r\n\x1a\n",
            chunk(b"IHDR", head),
            chunk(b"tEXt", b"Comment\0" + comment.encode("latin-1", "replace")),
            chunk(b"IDAT", zlib.compress(rows.data, compression)),
            chunk(b"IEND", b""),
        )
    )
