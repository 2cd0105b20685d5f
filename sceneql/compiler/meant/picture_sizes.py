"""Help for the size of a picture as other programs write it: ``640x360``, ``1280``, ``720``."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

LEAST = 16
"""Least number that can be meant for a width in pixels."""


def size_meant(text: str, choices: Collection[Any]) -> str | None:
    """The help for two numbers with a sign between them, a width alone, or a height that is one of the choices."""
    several = text.replace("x", " ").replace("*", " ").split()
    if len(several) > 1 and "".join(several).isdecimal():
        return f"write `{' '.join(several)}`"
    if f"{text}p" in map(str, choices):
        return f"write `{text}p`"
    if text.isdecimal() and int(text[:6]) >= LEAST:
        return f"write `{text} {max(2, 2 * round(int(text[:6]) * 9 / 32))}`, its width and its height"
    return None
