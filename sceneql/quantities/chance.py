"""Counter-based random numbers: each depends on its counters alone, not on earlier draws."""

from __future__ import annotations

import math
from typing import Any

MULTIPLIER, WEYL, MASK = 0xD256D193, 0x9E3779B9, 0xFFFFFFFF


def philox(first: Any, second: Any, key: Any) -> tuple[Any, Any]:
    """Philox2x32-10 (Salmon, Moraes, Dror & Shaw 2011, Parallel random numbers: as easy as 1, 2, 3, section 3.3).

    Counters and key below 2^32, as int or as uint64 arrays; so are the two results.
    """
    for _ in range(10):
        product = first * MULTIPLIER
        first, second = (product >> 32) ^ key ^ second, product & MASK
        key = (key + WEYL) & MASK
    return first, second


def unit(first: Any, second: Any) -> Any:
    """Uniform in [0, 1) from two words of 32 bits: the 53 highest bits."""
    return ((first << 21) | (second >> 11)) * 2.0**-53


def random(i: float, j: float = 0.0, k: float = 0.0) -> float:
    """Uniform in [0, 1) for the whole parts of i, j, k (modulo 2^32): Philox2x32-10 of counter (i, j) under key k."""
    if not (math.isfinite(i) and math.isfinite(j) and math.isfinite(k)):
        return math.nan
    words = [int(math.floor(x) % 2**32) for x in (i, j, k)]
    return float(unit(*philox(*words)))
