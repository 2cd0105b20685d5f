"""mp4: H.264 film, in process by PyAV behind imageio, whole under its final name or not there."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sceneql.files import beside

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

# x264's bytes depend on the number of its threads, so that is fixed; faststart lets a browser play while it loads.
OPTIONS = {"movflags": "+faststart", "fflags": "+bitexact"}


SEEK = 0.5
"""Seconds of film from key frame to key frame: where a player can go at once."""


class _Planes(list[Any]):
    """Planes as imageio takes them: by index, with a shape of their number and that of the first."""

    shape = (0, 0, 0)


def planes_of(picture: NDArray[uint8]) -> list[NDArray[uint8]]:
    """Luma (h, w) and both chroma (h/2, w/2) of a picture (h, w, 3), in BT.709's video range, dithered."""
    import numpy as np

    from renderers.encoders.video_planes_kernels import planes

    height, width = picture.shape[:2]
    halves = height // 2, width // 2
    found = _Planes(np.empty(size, dtype=np.uint8) for size in ((height, width), halves, halves))
    planes(np.ascontiguousarray(picture), *found)
    found.shape = (3, height, width)
    return found


class Writer:
    """Writes frames of one size at one rate; yuv420p, BT.709, playable everywhere."""

    def __init__(self, path: Path, *, size: tuple[int, int], rate: float, quality: float, comment: str) -> None:
        """Start a film. Raises ValueError for an odd size, which yuv420p cannot hold."""
        if size[0] % 2 or size[1] % 2:
            raise ValueError(f"a film's width and height must be even, not {size[0]} {size[1]}")
        self.path = path
        self.frames = 0
        self._temporary = path.with_name(f".{path.stem}.part.mp4")
        self._settings = (size, rate, quality, comment)
        self._file: Any = None

    def _open(self) -> Any:
        import imageio.v3 as iio

        (width, height), rate, quality, comment = self._settings
        self.path.parent.mkdir(parents=True, exist_ok=True)
        file: Any = iio.imopen(self._temporary, "w", plugin="pyav", extension=".mp4")
        file.init_video_stream("libx264", fps=float(rate), pixel_format="yuv420p")
        stream: Any = file._video_stream
        stream.width, stream.height = width, height
        # aq-mode=3 spends more on dark, even blocks, where bands would show.
        # Without mbtree=0 x264 was seen to give other bytes from run to run for the same frames, even on one thread.
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
        """Add a frame (h, w, 3)."""
        if self._file is None:
            self._file = self._open()
        self._file.write_frame(planes_of(picture), pixel_format="yuv420p")
        self.frames += 1

    def close(self) -> list[Path]:
        """Finish; the film appears under its name."""
        return self._finish(self.path)

    def abort(self) -> list[Path]:
        """Keep the frames so far, playable, beside the final name."""
        if self.frames == 0:
            self._temporary.unlink(missing_ok=True)
            return []
        try:
            return self._finish(beside(self.path, "partial"))
        except OSError:
            self._temporary.unlink(missing_ok=True)
            raise

    def _finish(self, path: Path) -> list[Path]:
        if self._file is None:
            return []
        self._file.close()
        with self._temporary.open("rb") as stream:
            os.fsync(stream.fileno())
        self._temporary.replace(path)
        return [path]
