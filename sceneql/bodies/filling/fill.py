"""Sample points inside an object, at which particles and lattices that fill it start."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

from sceneql.doing import doing
from sceneql.failure import LimitRefused
from sceneql.island.memory import PLACE, bounded
from sceneql.island.start import Start
from sceneql.kinds import Exceeds, FixedLength, Object, ObjectRef, Problem, Record, Ref, field
from sceneql.quantities.chance import philox, unit
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats, Tape
    from sceneql.system import Assembly

CHUNK = 1 << 18
EMPTIEST = 2000
"""An object that contains fewer than 1/EMPTIEST of its box's random points counts as empty."""
ALONG = 1e-9
"""Largest entry of a rotation, less 0 or 1, up to which axes lie along the world's."""


class Fill(Record):
    """Places inside an object, at the start of the run."""

    object: ObjectRef = field("The object to fill; usually a hidden one.")
    count: int | None = field("How many places.", None, at_least=1)
    spacing: FixedLength | None = field("In place of a count: distance of neighbors.", None, above=0)
    pattern: Literal["grid", "random", "even"] = field(
        "Rows along the axes, places by chance, or by chance but none close to another (blue noise).", "random"
    )
    seed: int = field("Another number, other places.", 0, at_least=0)

    def problems(self) -> Iterator[Problem]:
        """Problems: both or neither of `count` and `spacing`; a grid without `spacing`."""
        if (self.count is None) == (self.spacing is None):
            yield Problem("a filling has either `count` or `spacing`")
        elif self.pattern == "grid" and self.spacing is None:
            yield Problem("a grid needs a `spacing`", ("pattern",))

    def bounded(self, low: Floats, high: Floats) -> None:
        """Raise Exceeds where filling an object in the box low..high [m] is certain to take too many points."""
        import numpy as np

        assert self.spacing is not None
        if self.pattern == "grid":
            grid_counts(low, high, self.spacing)
        else:
            bounded(float(np.prod(np.maximum(high - low, 0.0) / self.spacing)) / EMPTIEST)


class Inside:
    """An object at the start of the run: its bounding box, and tests for points inside."""

    def __init__(self, ref: Ref, assembly: Assembly, own_axes: bool = False) -> None:
        """Raises ScriptError for an object without an inside or without an end."""
        import numpy as np

        from sceneql.shapes.placement import Placed

        kind: Any = assembly.object(ref)
        start: Any = Start(assembly)
        self.span = ref.span
        self.name = ref.name
        place = np.eye(3, 4)
        self.axes: Floats | None = None
        """(3, 3) with `own_axes` the object's axes, as columns, where they are not the world's: box, places and tests
        are then in these axes."""
        try:
            if own_axes and (axes := _axes(kind, start)) is not None:
                self.axes, place = axes, np.column_stack([axes.T, np.zeros(3)])
            low, high = kind.extent(place, start)
            self.low, self.high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
            if not (np.isfinite(self.low).all() and np.isfinite(self.high).all()):
                raise TypeError("it has no end")
            self._holds, self._crossing, self.field = _test(kind, start)
            self.smooth: bool = isinstance(kind, Placed) and kind.smooth(start)
            """Whether its surface is known to have no creases and no corners."""
        except (TypeError, ValueError) as error:
            raise self.refusal(str(error)) from None

    def holds(self, places: Floats) -> Any:
        """Whether places (n, 3) [m] lie inside, (n,) bool."""
        return self._holds(self.in_world(places))

    def crossing(self, inner: Floats, outer: Floats) -> Floats:
        """The shares (n,) of segments between places (n, 3) [m] at which these leave the object."""
        return self._crossing(self.in_world(inner), self.in_world(outer))

    def in_world(self, places: Floats) -> Floats:
        """Places (n, 3) [m] in the world."""
        return places if self.axes is None else places @ self.axes.T

    def refusal(self, why: str) -> ScriptError:
        """The error that says why the object cannot be filled."""
        return ScriptError([Diagnostic("not-filled", f"'{self.name}' cannot be filled: {why}", self.span)])

    def bounded(self, bound: Callable[..., object], *arguments: Any) -> None:
        """Call ``bound(*arguments)`` (as memory.bounded); raise LimitRefused where it raises Exceeds."""
        try:
            bound(*arguments)
        except Exceeds as error:
            raise LimitRefused(str(error), self.span, "use a larger spacing") from None

    def random(self, first: int, count: int, key: int) -> Floats:
        """Those (m, 3) of the box's random points number first to first + count - 1 that lie in the object."""
        import numpy as np

        index = np.arange(first, first + count, dtype=np.uint64)
        shares = np.stack([draws(index, axis, key) for axis in range(3)], axis=1)
        places = self.low + shares * (self.high - self.low)
        held: Floats = places[self.holds(places)]
        return held


def draws(index: Any, draw: int, key: int) -> Floats:
    """Uniform random numbers (n,) in [0, 1) for counters (index, draw); ``index`` (n,) uint64."""
    import numpy as np

    numbers: Floats = unit(*philox(index, np.full_like(index, draw), np.full_like(index, key)))
    return numbers


def chance_key(name: str, seed: int) -> int:
    """The key of a part's stream of counter-based random numbers."""
    import zlib

    return zlib.crc32(f"{seed}:{name}".encode())


def _axes(kind: Object, start: Any) -> Floats | None:
    """The axes (3, 3) of an object that is turned at the start, as columns; None where they lie along the world's."""
    import numpy as np

    from sceneql.shapes.placement import Placed, rotation_matrix

    if not isinstance(kind, Placed):
        return None
    axes = rotation_matrix(start.at(kind.rotation))
    along = np.minimum(abs(axes), abs(abs(axes) - 1.0)).max() < ALONG
    return None if along else axes


def _test(kind: Object, start: Any) -> tuple[Callable[[Floats], Any], Callable[[Floats, Floats], Floats], Tape | None]:
    """(holds, crossing, tape of the field or None for a mesh) of an object.

    ``holds``: places (n, 3) -> (n,) bool, whether they lie inside. ``crossing``: inner and outer ends (n, 3) of
    segments -> (n,) parameters at which these leave the object. Raises TypeError for an object without an inside.
    """
    import numpy as np

    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.field.tape.tape_solid import exits, field_values

    triangles = getattr(kind, "triangles_at", None)
    if triangles is not None:
        from sceneql.bodies.filling.winding import winding

        mesh = winding(triangles(start))
        return mesh.holds, mesh.exits, None
    build = TapeBuilder()
    tape = build.finish(kind.implicit(build, build.x, build.y, build.z, start))
    return lambda places: np.asarray(field_values(tape, places) < 0), partial(exits, tape), tape


def filled(fill: Fill, name: str, assembly: Assembly) -> Floats:
    """Points (n, 3) [m] of a filling. Raises ScriptError where the object contains none, LimitRefused for too many."""
    with doing(f"filling {fill.object.name}"):
        return _filled(fill, name, assembly)


def _filled(fill: Fill, name: str, assembly: Assembly) -> Floats:
    import numpy as np

    inside = Inside(fill.object, assembly)
    if fill.pattern == "grid":
        places = grid(inside, fill.spacing or 1.0)[0]
        inside.bounded(bounded, len(places))
        return places
    key = chance_key(name, fill.seed)
    size = float(np.prod(inside.high - inside.low))
    trial = inside.random(0, CHUNK, key)
    if len(trial) * EMPTIEST < CHUNK:
        raise inside.refusal("next to nothing of its box lies in it")
    volume = size * len(trial) / CHUNK
    wanted = fill.count
    if wanted is None:
        wanted = max(1, round(min(volume / (fill.spacing or 1.0) ** 3, 1e18)))
        inside.bounded(bounded, wanted)
    if fill.pattern == "even":
        from sceneql.bodies.filling.fill_kernels import spread

        apart = fill.spacing or (volume / wanted) ** (1 / 3)
        return _even(inside, trial, wanted, 0.85 * apart, key, spread)
    parts, have, first = [trial], len(trial), CHUNK
    while have < wanted:
        parts.append(inside.random(first, CHUNK, key))
        have, first = have + len(parts[-1]), first + CHUNK
    return np.concatenate(parts)[:wanted]


def _even(inside: Inside, trial: Floats, wanted: int, apart: float, key: int, spread: Any) -> Floats:
    """Poisson disk samples (wanted, 3); their distance shrinks when no more fit (McCool & Fiume 1992, section 3)."""
    import numpy as np

    room = np.ascontiguousarray(inside.high - inside.low)
    places, kept = np.empty((wanted, 3)), 0
    darts, first = trial, CHUNK
    while True:
        kept = spread(np.ascontiguousarray(darts), places, kept, inside.low, room, apart)
        if kept == wanted:
            return places
        apart *= 0.9
        darts, first = inside.random(first, CHUNK, key), first + CHUNK


def grid_counts(low: Floats, high: Floats, spacing: float) -> Floats:
    """Points (3,) of a cubic grid along the sides of a box. Raises Exceeds for too many points in all."""
    import numpy as np

    count: Floats = np.floor(np.maximum(high - low, 0.0) / spacing + 1e-9) + 1
    bounded(float(np.prod(count)), "places of a grid", PLACE)
    return count


def grid(inside: Inside, spacing: float) -> tuple[Floats, Any]:
    """Points (n, 3) [m] inside an object of a cubic grid about the middle of its box, and their grid indices (n, 3).

    Raises ScriptError where no point lies inside, LimitRefused where the grid has too many points to test.
    """
    import numpy as np

    inside.bounded(grid_counts, inside.low, inside.high, spacing)
    count = grid_counts(inside.low, inside.high, spacing)
    axes = [np.arange(int(c)) for c in count]
    cells = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    places = (inside.low + inside.high) / 2 + spacing * (cells - (count - 1) / 2)
    held = inside.holds(places)
    if not held.any():
        raise inside.refusal("no place of the grid lies in it; make the spacing smaller")
    return places[held], cells[held]
