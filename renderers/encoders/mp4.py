"""mp4: H.264 film by PyAV through imageio; the file appears under its name only when complete."""

from __future__ import annotations

import errno
import io
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sceneql.files import beside, discard, finish, hidden
from sceneql.interrupts import held

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

# x264's output depends on its number of threads, which is therefore fixed. faststart: browsers play while loading.
OPTIONS = {"movflags": "+faststart", "fflags": "+bitexact"}
AT_ONCE = 64
"""Largest number of frames that the encoder buffers."""
USUAL = 48
"""Bytes of a picture per byte of film (half a bit per pixel): estimate of a frame's size before any is written."""

SEEK = 0.5
"""Time [s] between key frames, to which a player can seek directly."""


class _Planes(list[Any]):
    """List of planes with the ``shape`` (planes, h, w) that imageio reads."""

    shape = (0, 0, 0)


def planes_of(picture: NDArray[uint8]) -> list[NDArray[uint8]]:
    """Luma (h, w) and both chroma planes (h/2, w/2) of a picture (h, w, 3), in BT.709's video range, dithered."""
    import numpy as np

    from renderers.encoders.video_planes_kernels import planes

    height, width = picture.shape[:2]
    halves = height // 2, width // 2
    found = _Planes(np.empty(size, dtype=np.uint8) for size in ((height, width), halves, halves))
    planes(np.ascontiguousarray(picture), *found)
    found.shape = (3, height, width)
    return found


class Writer:
    """Writer of frames of one size at one rate, as yuv420p in BT.709, which all players support."""

    def __init__(self, path: Path, *, size: tuple[int, int], rate: float, quality: float, comment: str) -> None:
        """Start a film. Raises ValueError for an odd size, which yuv420p cannot represent."""
        if size[0] % 2 or size[1] % 2:
            raise ValueError(f"a film's width and height must be even, not {size[0]} {size[1]}")
        self.path = path
        self.frames = 0
        self._made = hidden(path)
        self._settings = (size, rate, quality, comment)
        self._file: Any = None
        self._disk: Any = None

    def _open(self) -> Any:
        from importlib import import_module

        import_module("av")  # imageio reports any error of this import as a missing plug-in
        import imageio.v3 as iio

        (width, height), rate, quality, comment = self._settings
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._disk = _Disk(self._made, "xb")
        file: Any = iio.imopen(self._disk, "w", plugin="pyav", extension=".mp4")
        file.init_video_stream("libx264", fps=float(rate), pixel_format="yuv420p")
        stream: Any = file._video_stream
        stream.width, stream.height = width, height
        # aq-mode=3 gives more bits to dark, even blocks, where bands would be visible.
        # Without mbtree=0 x264 gave different bytes from run to run for the same frames, even on one thread.
        stream.options = {"crf": f"{quality:g}", "preset": "medium", "x264-params": "mbtree=0:aq-mode=3"}
        context = stream.codec_context
        context.thread_count, context.thread_type = 4, "FRAME"
        context.gop_size = max(1, round(rate * SEEK))
        context.color_primaries = context.color_trc = context.colorspace = 1  # BT.709
        context.color_range = 1
        file._container.options.update(OPTIONS)
        file.container_metadata["comment"] = comment
        return file

    def write(self, picture: NDArray[uint8]) -> None:
        """Add a frame (h, w, 3). Raises OSError before the disk is too full to finish the film, and MemoryError."""
        planes = planes_of(picture)
        with held():  # a signal within the encoder's callbacks would break it
            if self._file is None:
                self._file = self._open()
            self._leave_room(picture.size // USUAL)
            from av import ExternalError

            try:
                self._file.write_frame(planes, pixel_format="yuv420p")
            except ExternalError:
                bytearray(AT_ONCE * picture.size // 2 + 2**28)  # MemoryError, if that is the reason x264 hides
                raise
            self._disk.raise_error()
            self.frames += 1

    def _leave_room(self, usual: int) -> None:
        """Raise OSError if the encoder's buffered frames and the index of frames would not fit on the disk.

        ``usual``: estimated bytes per frame, used until enough frames are written.
        """
        out = self.frames - AT_ONCE
        each = self._made.stat().st_size // out if out > AT_ONCE else usual
        most = 2 * AT_ONCE * each if out > AT_ONCE else min(self.frames + 1, AT_ONCE) * each
        if shutil.disk_usage(self._made.parent).free < most + 64 * self.frames + 2**16:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def close(self) -> list[Path]:
        """Finish the film, which then appears under its name; returns its path."""
        return self._finish(self.path)

    def abort(self) -> list[Path]:
        """Keep the frames so far as a playable film beside the final name. Raises the OSError of a failed write."""
        return self._finish(beside(self.path, "partial"))

    def _finish(self, path: Path) -> list[Path]:
        file, self._file = self._file, None
        try:
            if file is not None:
                self._end(file)
            if self._disk is not None:
                self._disk.close()
                self._disk.raise_error()
            if not self.frames:
                return []
            finish(self._made, path)
        finally:
            discard(self._made)
        return [path]

    def _end(self, file: Any) -> None:
        """Close the encoder. After a failure its stream is dropped, so that garbage collection does not flush it."""
        try:
            if not self.frames:
                file._video_stream = None
            file.close()
        finally:
            file._video_stream = file._video_filter = None


class _Disk(io.FileIO):
    """File that keeps its first error for later; the encoder would print it many times and become unusable."""

    error: OSError | None = None

    def write(self, data: Any) -> int:
        """Write all data, unless there has been an error; returns the full length in any case."""
        rest = memoryview(data)
        try:
            while len(rest) and self.error is None:
                rest = rest[super().write(rest) :]
        except OSError as error:
            self.error = error
        return len(data)

    def raise_error(self) -> None:
        """Raise the kept error, if any."""
        if self.error is not None:
            raise self.error
