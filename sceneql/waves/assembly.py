"""Wave on cells: state, numbers and term in the island."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sceneql.grids.assembly import spread_of
from sceneql.grids.at_points import at_points
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Call
from sceneql.system import Slopes

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.ground import Ground
    from sceneql.grids.medium import Part, Picture
    from sceneql.kinds import Formula
    from sceneql.system import Assembly, ModelState


class Wave(Protocol):
    """Fields of a word that describes a wave."""

    @property
    def speed(self) -> Formula:
        """Wave speed c [m/s] by place."""

    @property
    def initial(self) -> Formula | Picture | None:
        """Field at the start; None: 0."""

    @property
    def velocity(self) -> Formula | None:
        """Rate of the field at the start; None: 0."""

    @property
    def damping(self) -> Formula | None:
        """Decay rate of amplitudes [1/s] by place; None: 0."""

    @property
    def source(self) -> Formula | None:
        """Second time derivative that is added to the field; None: 0."""


@dataclass(frozen=True, slots=True)
class _Field:
    """Wave as a spreading field (grids.assembly.Spreading) with the squared speed as its coefficient."""

    coefficient: Formula
    initial: Formula | Picture | None
    source: Formula | None
    made = True
    positive = False


def add_wave(wave: Wave, boundary: Mapping[str, Part], ground: Ground, assembly: Assembly) -> tuple[int, ...]:
    """Reserve the field, its velocity and their tallies, and add the term of their rates.

    Returns the offset of the field and the offsets that `energies` reads. Raises ScriptError for numbers that are not
    finite, a speed or damping below 0, and boundary parts that overlap.
    """
    n = ground.count
    square = Call("mul", (wave.speed.expr, wave.speed.expr), wave.speed.expr.type)
    field = _Field(type(wave.speed)(square, wave.speed.span), wave.initial, wave.source)
    speeds = _finite("speed", wave.speed, ground)
    spread = spread_of(field, dict(boundary), ground, assembly)
    velocity_at = assembly.state(np.append(_finite("velocity", wave.velocity, ground), 0.0))
    assert velocity_at == spread.at + n + 1
    assembly.pair(spread.at, velocity_at, n + 1)
    assembly.alike(spread.at, n)
    assembly.alike(velocity_at, n)
    for tally in (spread.at + n, velocity_at + n):  # of a mode between held edges they are the rounding of all others
        assembly.alike(tally, 1)
    damping = _finite("damping", wave.damping, ground)
    for name, formula, values in (("speed", wave.speed, speeds), ("damping", wave.damping, damping)):
        if formula is not None and values.min() < 0.0:
            text = f"the {name} must be at least 0, and is {values.min():g} somewhere"
            raise ScriptError([Diagnostic("out-of-range", text, formula.span)])
    decays = 2.0 * damping
    for one in spread.radiating:
        np.add.at(decays, one.cells, one.areas * speeds[one.cells] / ground.cells.volumes[one.cells])
    decays_at = assembly.floats(decays)

    def slopes() -> Slopes:
        rows, columns = spread.places()
        own = np.arange(n)
        by_velocity = velocity_at + own
        return Slopes(
            "sceneql.waves.wave_slopes_kernels:wave",
            np.concatenate([spread.at + own, by_velocity, rows + n + 1]),
            np.concatenate([by_velocity, by_velocity, columns]),
            (n, decays_at, *spread.more),
        )

    assembly.term("close", "sceneql.waves.wave_kernels:wave", (n, decays_at, *spread.ints), slopes)
    _, _, _, _, _, sink, fed, *faces, _ = spread.ints
    return (spread.at, sink, fed, *faces)


def energies(
    at: int, ints: tuple[int, ...], shape: tuple[int, int, int], volumes: Floats, state: ModelState
) -> tuple[float, ...]:
    """Parts of the energy: half the sums of V v^2, of sink u^2 and of g (difference)^2 over faces; minus that of fed u.

    ``at``: offset of the field; ``ints``: offsets of sink, fed and conductances.
    """
    n = len(volumes)
    u, v = state.y[at : at + n], state.y[at + n + 1 : at + 2 * n + 1]
    sink, fed, *faces = (state.floats[first : first + n] for first in ints)
    grid, strained = u.reshape(shape[::-1]), 0.0
    for axis in range(3 if shape[2] > 1 else 2):
        away = grid - np.roll(grid, 1, axis=2 - axis)
        strained += float(faces[axis] @ (away * away).ravel())
    return 0.5 * float(volumes @ (v * v)), 0.5 * float(sink @ (u * u)), 0.5 * strained, -float(fed @ u)


def _finite(what: str, formula: Formula | None, ground: Ground) -> Floats:
    """Values (cells,) of a formula inside the domain, 0 outside. Raises ScriptError for values that are not finite."""
    if formula is None:
        return np.zeros(ground.count)
    with np.errstate(all="ignore"):
        values = np.where(ground.inside, at_points(formula, ground.centers), 0.0)
    if not np.isfinite(values).all():
        x, y, z = ground.centers[np.flatnonzero(~np.isfinite(values))[0]]
        text = f"the {what} is not finite at ({x:g}, {y:g}, {z:g}) m"
        raise ScriptError([Diagnostic("not-finite", text, formula.span)])
    return values
