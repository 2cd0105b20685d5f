"""Mass-spring networks: script fields of a lattice, cloth, rope or single masses, and the network made from them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from dataclasses import field as member
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Annotated, Any

from sceneql import kinds
from sceneql.island.memory import bounded_net
from sceneql.kinds import Exceeds, Problem, Quantity, Record, field
from sceneql.quantities import dimension as dim
from sceneql.shapes.placement import unit_vector

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints
    from sceneql.system import Skin

SIDES = ("left", "right", "bottom", "top", "back", "front")
EDGES = ("left", "right", "bottom", "top")
STEPS = tuple(step for step in product((-1, 0, 1), repeat=3) if step > (0, 0, 0))
"""Offsets from a grid point to its neighbors, each pair once."""
THINNEST = 1e6
"""Largest ratio of a cloth cell's sides; beyond it rounding along the long side disturbs the short one."""
CORNERS = ("bottom_left", "bottom_right", "top_left", "top_right")
ROPE_ENDS = ("start", "end")


@dataclass(frozen=True, slots=True, eq=False)
class Net:
    """A network of masses and springs at the start of a run."""

    points: Floats
    """(n, 3) [m] positions."""
    pairs: NDArray[int64]
    """(m, 2) numbers of the masses at each spring's ends."""
    stiffness: Floats
    """(m,) stiffness of each spring relative to the model's."""
    places: dict[str, Any] = member(default_factory=dict)
    """By name for pins: indices or masks of masses."""
    triangles: Ints | None = None
    """(k, 3) masses at the corners of the surface's triangles, counterclockwise seen from its front or outside."""
    toughness: Floats | None = None
    """(m,) strain at which each spring tears relative to the model's; None: all 1."""
    line: bool = False
    """Whether it is a rope."""
    tetrahedra: Ints | None = None
    """(t, 4) corners of a solid's tetrahedra, of positive volume at the start."""
    masses: Floats | None = None
    """(n,) [kg]; None: the model's mass for all."""
    springs: Floats | None = None
    """(m,) [N/m] absolute stiffness in place of the model's."""
    dampers: Floats | None = None
    """(m,) [N s/m] absolute damping in place of the model's."""
    fills: Floats | None = None
    """(n,) [m^3] volume of each mass's share of the solid, for a single layer area [m^2]; None: it fills no volume."""
    layer: bool = False
    """Whether it is a single layer of masses across z."""
    apart: float = 0.0
    """[m] distance of neighboring masses, between which a fluid does not pass; 0: unknown."""


def alike(net: Net) -> Floats:
    """Blocks (m, 5) of the springs (springs.SpringModel.make), unstretched at the start.

    Stiffness and damping are the net's absolute ones where it has them, else relative to the model's.
    """
    import numpy as np

    blocks = np.zeros((len(net.pairs), 5))
    blocks[:, 0] = np.linalg.norm(net.points[net.pairs[:, 1]] - net.points[net.pairs[:, 0]], axis=1)
    blocks[:, 2] = blocks[:, 4] = net.stiffness
    if net.springs is not None:
        blocks[:, 1], blocks[:, 2] = net.springs, 0.0
    if net.dampers is not None:
        blocks[:, 3], blocks[:, 4] = net.dampers, 0.0
    return blocks


def faces_of(net: Net, stiffnesses: Floats, radius: float) -> Skin:
    """The faces of a cloth or a solid, that a barrier keeps apart.

    ``stiffnesses`` (m,) [N/m] of the springs, ``radius`` [m] of the masses. A stiffness k along the faces' sides stands
    for the modulus k over the thickness of a sheet, twice the radius, and over the distance of masses in a solid. None
    is marked as held: pins, which have no inverse mass, let go.
    """
    import numpy as np

    from sceneql.system import Skin

    triangles, n = np.asarray(net.triangles, dtype=np.int64), len(net.points)
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1) @ [n, 1]
    along = np.isin(np.sort(net.pairs, axis=1) @ [n, 1], sides)
    thick = net.apart if net.tetrahedra is not None or radius == 0.0 else 2.0 * radius
    return Skin(triangles, np.zeros((n, 3), dtype=bool), float(np.median(stiffnesses[along])) / thick)


def turned(points: Floats, center: Sequence[float], quaternion: Sequence[float]) -> Floats:
    """Points (n, 3) [m] rotated about a center by a unit quaternion [w, x, y, z]."""
    import numpy as np

    w, axis, away = quaternion[0], np.asarray(quaternion[1:]), points - np.asarray(center)
    moved: Floats = points + 2 * np.cross(axis, np.cross(axis, away) + w * away)
    return moved


class MassPoint(Record):
    """One named mass."""

    mass: kinds.FixedMass | None = field("Its mass; by default the model's.", None, above=0)
    position: kinds.FixedPosition = field("Where it starts.", "0 0 0 m")
    velocity: kinds.FixedVelocity | None = field("How fast it starts; by default the model's.", None)
    fixed: bool = field("It never moves.", False)

    def problems(self) -> Iterator[Problem]:
        """A problem for a fixed mass with a velocity."""
        if self.fixed and self.velocity is not None and any(self.velocity):
            yield Problem("a fixed mass has no velocity", ("velocity",))


class Spring(Record):
    """One spring between two named masses."""

    between: tuple[str, str] = field("The masses at its ends.")
    rest: kinds.FixedLength | None = field(
        "Its length without force; by default the distance at the start.", None, at_least=0
    )
    stiffness: kinds.FixedStiffness | None = field("Force for a stretch; by default the model's.", None, above=0)
    damping: kinds.FixedDamping | None = field(
        "Force for a speed of stretching; by default the model's.", None, at_least=0
    )
    name: str | None = field("Its name, for `name.length` and `name.tension`.", None)

    def problems(self) -> Iterator[Problem]:
        """A problem for a spring from a mass to itself."""
        if self.between[0] == self.between[1]:
            yield Problem(f"a spring from '{self.between[0]}' to itself", ("between",))


def _too_many(masses: float, springs: float, field: str) -> Iterator[Problem]:
    try:
        bounded_net(masses, springs)
    except Exceeds as error:
        yield Problem(str(error), (field,), code="limit-refused")


def neighbors(cells: Any, shear: float) -> tuple[NDArray[int64], Floats]:
    """Springs (m, 2) between neighboring grid points, and their relative stiffness (m,).

    ``cells`` (n, 3): integer coordinates; neighbors differ by at most 1 along each axis. The stiffness is 1 along an
    axis and ``shear`` along diagonals, which have no springs if it is 0.
    """
    import numpy as np

    index = np.full(np.max(cells, axis=0) + 1, -1, dtype=np.int64)
    index[tuple(cells.T)] = np.arange(len(cells))
    pairs, parts = [np.zeros((0, 2), dtype=np.int64)], [np.zeros(0)]
    for step in sorted(STEPS, key=lambda s: (sum(map(abs, s)), s)):
        part = 1.0 if sum(map(abs, step)) == 1 else shear
        if part == 0:
            continue
        here = tuple(slice(max(0, -s), c - max(0, s)) for s, c in zip(step, index.shape, strict=True))
        there = tuple(slice(max(0, s), c - max(0, -s)) for s, c in zip(step, index.shape, strict=True))
        found = np.stack([index[here].ravel(), index[there].ravel()], axis=1)
        found = found[(found >= 0).all(axis=1)]
        pairs.append(found)
        parts.append(np.full(len(found), part))
    return np.concatenate(pairs), np.concatenate(parts)


def side_masks(cells: Any) -> dict[str, Any]:
    """By the names of SIDES, masks (n,) of the points on each side; ``cells`` (n, 3): integer coordinates."""
    low, high = cells.min(axis=0), cells.max(axis=0)
    masks = [mask for axis in range(3) for mask in (cells[:, axis] == low[axis], cells[:, axis] == high[axis])]
    return dict(zip(SIDES, masks, strict=True))


class Lattice(Record):
    """A block of masses: springs along the edges of its cells and along their face and body diagonals."""

    count: tuple[int, int, int] = field("Masses along x, y and z.", (3, 3, 3), at_least=1)
    spacing: kinds.FixedLength = field("Distance of neighbors.", "0.3 m", above=0)
    center: kinds.FixedPosition = field("Where its middle starts.", "0 0 0 m")
    rotation: kinds.Rotation | None = field("How it is turned at the start.", None)
    shear: kinds.FixedScalar = field(
        "Stiffness of the diagonals as a part of the edges'; 0 leaves them out.", "1", at_least=0
    )

    def lowest(self) -> float:
        """Height y [m] of its lowest masses at the start."""
        sides = [(count - 1) * self.spacing / 2 for count in self.count]
        w, x, y, z = (1.0, 0.0, 0.0, 0.0) if self.rotation is None else self.rotation.number()
        upwards = (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x))  # of its own axes
        reach: float = sum(abs(up) * side for up, side in zip(upwards, sides, strict=True))
        return self.center[1] - reach

    def problems(self) -> Iterator[Problem]:
        """More masses than are possible."""
        yield from _too_many(self.mass_count(), self.spring_count(), "count")

    def mass_count(self) -> int:
        """Number of masses."""
        return prod(self.count)

    def spring_count(self) -> int:
        """Number of springs."""
        steps = [step for step in STEPS if self.shear or sum(map(abs, step)) == 1]
        return sum(prod(c - abs(s) for c, s in zip(self.count, step, strict=True)) for step in steps)

    def stiffest(self) -> float:
        """Bound on (angular frequency)^2 mass / stiffness."""
        steps = [step for step in product(*map(_sides, self.count)) if any(step)]
        return stiffest((step, 1.0 if sum(map(abs, step)) == 1 else self.shear) for step in steps)

    def net(self) -> Net:
        """The network before its rotation; masses ordered by x, then y, then z (z fastest)."""
        import numpy as np

        count = np.array(self.count)
        grid = np.stack(np.meshgrid(*(np.arange(c) for c in count), indexing="ij"), axis=-1).reshape(-1, 3)
        pairs, parts = neighbors(grid, self.shear)
        last = count - 1
        return Net(
            points=np.array(self.center) + self.spacing * (grid - last / 2),
            pairs=pairs,
            stiffness=parts,
            places=side_masks(grid),
            fills=self._fills(grid),
            layer=self.count[2] == 1,
            apart=self.spacing,
        )

    def _fills(self, grid: Any) -> Floats | None:
        """Volumes (n,) [m^3] of the masses' shares, areas [m^2] for one layer across z; halved on each side.

        None where it is a single line or column of masses.
        """
        import numpy as np

        if min(self.count[:2]) < 2:
            return None
        sizes = np.array([self.spacing if count > 1 else 1.0 for count in self.count])
        ends = ((grid == 0) | (grid == np.array(self.count) - 1)) & (np.array(self.count) > 1)
        found: Floats = sizes.prod() * np.where(ends, 0.5, 1.0).prod(axis=1)
        return found


class Cloth(Record):
    """A sheet of square cells with springs along their sides, along their diagonals, and over two cells.

    The three kinds resist stretching, shearing and bending (Provot 1995).
    """

    size: Annotated[tuple[float, float], Quantity(dim.LENGTH, (2,))] = field("Width and height.", "2 2 m", above=0)
    cells: tuple[int, int] = field("Cells across the width and the height.", (20, 20), at_least=1)
    center: kinds.FixedPosition = field("Where its middle starts.", "0 2 0 m")
    facing: kinds.Axis = field("Where its front faces: y lies flat, z hangs with its top up.", "0 1 0")
    shear: kinds.FixedScalar = field("Stiffness of the diagonals as a part of the sides'.", "0.5", at_least=0)
    bend: kinds.FixedScalar = field("Stiffness over two cells as a part of the sides'.", "0.1", at_least=0)

    def lowest(self) -> float:
        """Height y [m] of its lowest masses at the start; a lower bound for a tilted cloth."""
        upright = math.sqrt(max(1 - (self.facing[1] / math.hypot(*self.facing)) ** 2, 0.0))
        reach = self.size[1] if upright == 1 else math.hypot(*self.size)
        return self.center[1] - 0.5 * reach * upright

    def problems(self) -> Iterator[Problem]:
        """Problems: too many masses; cells too long for their width."""
        sorts = 1 + (self.shear > 0) + (self.bend > 0)
        yield from _too_many(self.mass_count(), 2 * sorts * self.mass_count(), "cells")
        narrow, long = sorted(side / cells for side, cells in zip(self.size, self.cells, strict=True))
        if not long <= THINNEST * narrow:
            told = f"cells of {narrow:.3g} by {long:.3g} m: at most {THINNEST:,.0f} times as long as wide are simulated"
            yield Problem(told, ("size",))

    def mass_count(self) -> int:
        """Number of masses."""
        return (self.cells[0] + 1) * (self.cells[1] + 1)

    def stiffest(self) -> float:
        """Bound on (angular frequency)^2 mass / stiffness."""
        across, along = (side / cells for side, cells in zip(self.size, self.cells, strict=True))
        columns, rows = self.cells[0] + 1, self.cells[1] + 1
        near = [(i * across, j * along, 0.0) for i in _sides(columns) for j in _sides(rows) if i or j]
        far = [(i * across, 0.0, 0.0) for i in _sides(columns, 2) if i]
        far += [(0.0, j * along, 0.0) for j in _sides(rows, 2) if j]
        sides = [(step, self.shear if step[0] and step[1] else 1.0) for step in near]
        return stiffest([*sides, *((step, self.bend) for step in far)])

    def net(self) -> Net:
        """The network; masses ordered by columns from the left, each from bottom to top."""
        import numpy as np

        normal = unit_vector(self.facing)
        side = np.cross((0.0, 1.0, 0.0), normal)
        length = np.linalg.norm(side)
        right = side / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
        up = np.cross(normal, right)
        columns, rows = self.cells[0] + 1, self.cells[1] + 1
        across, along = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows), indexing="ij")
        u, v = across.ravel(), along.ravel()
        flat = (u - 0.5)[:, None] * self.size[0] * right + (v - 0.5)[:, None] * self.size[1] * up
        index = np.arange(columns * rows).reshape(columns, rows)
        a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
        groups = [
            (index[:-1], index[1:], 1.0),
            (index[:, :-1], index[:, 1:], 1.0),
            (a, c, self.shear),
            (b, d, self.shear),
            (index[:-2], index[2:], self.bend),
            (index[:, :-2], index[:, 2:], self.bend),
        ]
        groups = [group for group in groups if group[2] > 0]
        left, right_edge, bottom, top = u == 0, u == 1, v == 0, v == 1
        corners = (bottom & left, bottom & right_edge, top & left, top & right_edge)
        return Net(
            points=np.array(self.center) + flat,
            pairs=np.concatenate([np.stack([i.ravel(), j.ravel()], axis=1) for i, j, _ in groups]),
            stiffness=np.concatenate([np.full(i.size, part) for i, _, part in groups]),
            places={
                **dict(zip(EDGES, (left, right_edge, bottom, top), strict=True)),
                **dict(zip(CORNERS, corners, strict=True)),
            },
            triangles=np.concatenate(
                [np.stack([i.ravel(), j.ravel(), k.ravel()], axis=1) for i, j, k in ((a, b, c), (a, c, d))]
            ).astype(np.int32),
            apart=max(side / cells for side, cells in zip(self.size, self.cells, strict=True)),
        )


class Rope(Record):
    """A line of masses, each tied to the next."""

    from_: kinds.FixedPosition = field("Where its first mass starts.", "0 2 0 m")
    to: kinds.FixedPosition = field("Where its last mass starts.", "2 2 0 m")
    count: int = field("Number of masses.", 20, at_least=2)

    def lowest(self) -> float:
        """Height [m] of its lower end at the start."""
        return min(self.from_[1], self.to[1])

    def problems(self) -> Iterator[Problem]:
        """Problems: too many masses; a rope without length."""
        yield from _too_many(self.mass_count(), self.mass_count(), "count")
        if self.from_ == self.to:
            yield Problem("a rope that ends where it starts", ("to",))

    def mass_count(self) -> int:
        """Number of masses."""
        return self.count

    def stiffest(self) -> float:
        """Bound on (angular frequency)^2 mass / stiffness."""
        return stiffest(((float(step), 0.0, 0.0), 1.0) for step in _sides(self.count) if step)

    def net(self) -> Net:
        """The network; masses ordered from the start to the end."""
        import numpy as np

        index = np.arange(self.count)
        return Net(
            points=np.linspace(self.from_, self.to, self.count),
            pairs=np.stack([index[:-1], index[1:]], axis=1),
            stiffness=np.ones(self.count - 1),
            places=dict(zip(ROPE_ENDS, (index == 0, index == self.count - 1), strict=True)),
            line=True,
            apart=math.dist(self.from_, self.to) / (self.count - 1),
        )


def stiffest(offsets: Iterable[tuple[Sequence[float], float]]) -> float:
    """Upper bound on (angular frequency)^2 mass / stiffness of a net whose masses all have springs to these neighbors.

    ``offsets``: (vector to the neighbor, stiffness relative to the model's). Since (n (x - y))^2 <= 2 (n x)^2 +
    2 (n y)^2, the bound is twice the largest eigenvalue of the sum of n n^T over a mass's springs of direction n, here
    bounded by row sums (Gershgorin 1931). It is sharp for large nets of edges and diagonals.
    """
    rows = [[0.0] * 3 for _ in range(3)]
    for vector, part in offsets:
        square = sum(x * x for x in vector)
        for i, row in enumerate(rows):
            for j in range(3):
                row[j] += part * vector[i] * vector[j] / square
    return 2.0 * max(sum(map(abs, row)) for row in rows)


def _sides(count: int, reach: int = 1) -> tuple[int, ...]:
    """Offsets of the neighbors at distance ``reach`` of a mass in a row of ``count``, and 0."""
    if count <= reach:
        return (0,)
    return (0, reach) if count <= 2 * reach else (-reach, 0, reach)
