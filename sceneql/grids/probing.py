"""Probes of fields on grids: what is wrong with their names and places."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence

from sceneql.kinds import Problem

Probes = Mapping[str, Sequence[float]]
"""Places [m] by name."""


def misnamed(probes: Probes, taken: Container[str]) -> Iterable[Problem]:
    """Problems of names that are ``taken``, and of places without two or three numbers."""
    for name, place in probes.items():
        if name in taken or not name.isidentifier():
            yield Problem(f"a probe cannot be called '{name}'", ("probes", name), at_key=True)
        if len(place) not in (2, 3):
            yield Problem("a probe stands at two or three numbers, `0.5 0.2 m`", ("probes", name))


def outside(probes: Probes, corner: Sequence[float], size: Sequence[float]) -> Iterable[Problem]:
    """Problems of places outside of a box, by its low corner and its sides [m]."""
    for name, place in probes.items():
        if any(not 0.0 <= x - low <= side for x, low, side in zip(place, corner, size, strict=False)):
            ends = corner, [low + side for low, side in zip(corner, size, strict=True)]
            box = " to ".join(", ".join(f"{x:g}" for x in end) for end in ends)
            text = f"the probe '{name}' stands outside of the box from {box} m"
            yield Problem(text, ("probes", name), code="probe-outside")
