"""The names of maps of colors, for the fields of words."""

from __future__ import annotations

from typing import Literal

ColorMap = Literal["viridis", "inferno", "gray", "coolwarm"]
