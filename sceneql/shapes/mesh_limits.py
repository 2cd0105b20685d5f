"""Limits on the sizes of mesh files, and the errors of files that exceed them."""

from __future__ import annotations

from sceneql.kinds import Exceeds

MOST_TRIANGLES = 4_000_000
MOST_VERTICES = 3 * MOST_TRIANGLES
"""Vertices of MOST_TRIANGLES triangles that share none."""
LARGEST_STREAM = 2**30
"""Most bytes of a file that is read block by block."""
LARGEST_BINARY = 2**29
"""Most bytes of a file that is read as a whole into arrays."""
LARGEST_DESCRIPTION = 2**24
"""Most bytes of the JSON of a glTF; one letter beyond Latin makes Python store it with four bytes a letter."""
LARGEST_TEXT = 2**26
"""Most bytes of a file that is read as a whole into many small objects."""


def within(size: int, most: int, why: str = "") -> None:
    """Raise Exceeds for more bytes than a file may have."""
    if size > most:
        raise Exceeds(f"has {size:,} bytes, more than the {most:,} that {why or 'a mesh may have'}")


def counted(triangles: int, vertices: int) -> None:
    """Raise Exceeds for more triangles or vertices than a mesh may have."""
    if triangles > MOST_TRIANGLES:
        raise Exceeds(f"has {triangles:,} triangles, more than the {MOST_TRIANGLES:,} that a mesh may have")
    if vertices > MOST_VERTICES:
        raise Exceeds(f"has {vertices:,} vertices, more than the {MOST_VERTICES:,} that a mesh may have")


def unreadable(name: str, why: object) -> OSError:
    """The error of a file that cannot be read as the mesh that its name says; bytes that cannot be shown are not."""
    form = name.rpartition(".")[2].upper()
    text = "".join(c if c.isprintable() else "?" for c in str(why)[:200])
    return OSError(f"{name} is no {form} mesh that can be read: {text}")
