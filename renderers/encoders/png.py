"""png: one picture, or a numbered row of them; no video library is imported."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sceneql.files import whole

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray


class Writer:
    """Writes ``name.png``, or ``name.0000.png``, ``name.0001.png``, ...; every file is whole when it appears."""

    def __init__(self, path: Path, *, numbered: bool, comment: str, compression: int = 6) -> None:
        """``compression``: zlib's level (RFC 1950), from 0, none, to 9."""
        self.path, self.numbered, self.comment, self.compression = path, numbered, comment, compression
        self.made: list[Path] = []

    def write(self, picture: NDArray[uint8]) -> None:
        """Add a picture (h, w, 3)."""
        from PIL import Image, PngImagePlugin

        path = self.path.with_name(f"{self.path.stem}.{len(self.made):04d}.png") if self.numbered else self.path
        notes = PngImagePlugin.PngInfo()
        notes.add_text("Comment", self.comment)
        with whole(path) as stream:
            Image.fromarray(picture).save(stream, "png", pnginfo=notes, compress_level=self.compression)
        self.made.append(path)

    def close(self) -> list[Path]:
        """The files made."""
        return self.made

    def abort(self) -> list[Path]:
        """The files made: each is whole."""
        return self.made
