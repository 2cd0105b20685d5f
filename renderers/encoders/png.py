"""png: one picture, or a numbered row of them; no video library is imported."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from sceneql.files import whole

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray


class Writer:
    """Writes ``name.png``, or ``name.0000.png``, ``name.0001.png``, ...; every file is whole when it appears.

    With more than one thread a row's pictures are encoded beside what follows, one at a time: a picture is not to be
    changed after ``write``, and an error is raised by the next one or at the end.
    """

    def __init__(self, path: Path, *, numbered: bool, comment: str, compression: int = 6) -> None:
        """``compression``: zlib's level (RFC 1950), from 0, none, to 9."""
        self.path, self.numbered, self.comment, self.compression = path, numbered, comment, compression
        self.made: list[Path] = []
        self._count = 0
        self._beside: ThreadPoolExecutor | None = None
        self._last: Future[None] | None = None

    def write(self, picture: NDArray[uint8]) -> None:
        """Add a picture (h, w, 3)."""
        from sceneql.compiled.kernels import thread_count

        self._settle()
        path = self.path.with_name(f"{self.path.stem}.{self._count:04d}.png") if self.numbered else self.path
        self._count += 1
        if self.numbered and thread_count() > 1:
            self._beside = self._beside or ThreadPoolExecutor(1, thread_name_prefix="png")
            self._last = self._beside.submit(self._save, picture, path)
        else:
            self._save(picture, path)

    def close(self) -> list[Path]:
        """The files made."""
        try:
            self._settle()
        finally:
            self._end()
        return self.made

    def abort(self) -> list[Path]:
        """The files made: each is whole."""
        with suppress(Exception):  # the error that ends the run is the one to tell
            self._settle()
        self._end()
        return self.made

    def _save(self, picture: NDArray[uint8], path: Path) -> None:
        from PIL import Image, PngImagePlugin

        notes = PngImagePlugin.PngInfo()
        notes.add_text("Comment", self.comment)
        with whole(path) as stream:
            Image.fromarray(picture).save(stream, "png", pnginfo=notes, compress_level=self.compression)
        self.made.append(path)

    def _settle(self) -> None:
        """Wait for the last picture. Raises its error, once."""
        last, self._last = self._last, None
        if last is not None:
            last.result()

    def _end(self) -> None:
        if self._beside is not None:
            self._beside.shutdown()
            self._beside = None
