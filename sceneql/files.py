"""Files that are whole under their final name, or not there: written beside it first, then renamed."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


def beside(path: Path, mark: str) -> Path:
    """``film.mp4`` with mark ``partial`` is ``film.partial.mp4``."""
    return path.with_name(f"{path.stem}.{mark}{path.suffix}")


@contextmanager
def whole(path: Path) -> Iterator[BinaryIO]:
    """A binary file that appears as ``path`` when the block ends without an exception, and else not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.part")
    try:
        with temporary.open("wb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
