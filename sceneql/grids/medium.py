"""Base of the models of fields on grids: domain, boundary conditions, probes and outputs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Protocol

from sceneql import kinds
from sceneql.grids.domain.cells import MOST_CELLS, SIDES, centers_of, counts, too_far
from sceneql.grids.probing import misnamed, outside
from sceneql.kinds import Formula, Gives, Model, Problem, Quantity, Record, Symbols, field, quantity_type
from sceneql.kinds.probed import Probed
from sceneql.kinds.stable_step import StaticScene
from sceneql.kinds.values import TIME
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError, suggestion
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Link, Symbol, walk

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import Assembly, ModelState

PLACE = Annotated[Formula, Symbols(("x", "y", "z"), at_start=True)]
ANY = ("x", "y", "z", "t", "c")
VALUE = Annotated[Formula, Symbols(ANY, dim.PLAIN, of_field=True)]
START = Annotated[Formula, Symbols(("x", "y", "z"), dim.PLAIN, of_field=True, at_start=True)]
FLUX = Annotated[Formula, Symbols(ANY, dim.VELOCITY, of_field=True)]
SOURCE = Annotated[Formula, Symbols(ANY, dim.FREQUENCY, of_field=True)]
MEASURES = ("field", "concentration", "temperature", "centers", "mass", "inflow", "max", "min", "mean")
SHORTEST = 1e-100
"""[m] Least side of a domain or of a cell: diffusion rates over shorter ones overflow."""
SIZES = Annotated[tuple[float, ...], Quantity(dim.LENGTH, (None,))]


class Spaced(Protocol):
    """Script fields of the cells of a field or a flow."""

    @property
    def size(self) -> tuple[float, ...] | None:
        """Sides [m] of a box domain; None for an object as domain."""

    @property
    def domain(self) -> kinds.Ref | None:
        """The object whose inside is the domain, in place of a box."""

    @property
    def flat(self) -> bool:
        """Whether only the object's section at z = 0 is the domain."""

    @property
    def cell(self) -> float:
        """Largest side of a cell [m]."""


ON_SIDE = 1e-9
"""Distance beyond a side of the grid, in cells, that counts as rounding."""


@dataclass(frozen=True, slots=True)
class FieldLayout:
    """A field on its grid: cell (i, j, k) is y[at + i + nx (j + ny k)]; cells with volume 0 are outside the domain."""

    shape: tuple[int, int, int]
    at: int
    volumes_at: int
    """Offset of the volumes in the floats."""
    low: tuple[float, ...]
    """Low corner [m]."""
    spacing: tuple[float, ...]
    """Sides of a cell [m]."""

    @property
    def count(self) -> int:
        """Number of cells, those outside the domain included."""
        return self.shape[0] * self.shape[1] * self.shape[2]

    def cell(self, place: tuple[float, ...]) -> int:
        """Number of the cell at a place [m]; on an outer side the adjacent cell; -1 beyond the grid."""
        index = [0, 0, 0]
        for axis, (x, low, side, n) in enumerate(zip(place, self.low, self.spacing, self.shape, strict=False)):
            at = (x - low) / side
            if not -ON_SIDE <= at <= n + ON_SIDE:
                return -1
            index[axis] = min(max(math.floor(at), 0), n - 1)
        return index[0] + self.shape[0] * (index[1] + self.shape[1] * index[2])

    def centers(self) -> Floats:
        """Centers (cells, 3) [m] of all cells."""
        return centers_of(self.shape, self.low, self.spacing)


class Between(Protocol):
    """An interpolation of a field between the points where its values are known."""

    @property
    def what(self) -> str:
        """Name of the places with values: `cells` or `nodes`."""

    @property
    def count(self) -> int:
        """Number of values."""

    @property
    def known(self) -> Any:
        """Which entries of `gridded` lie in the domain."""

    def filled(self, values: Floats) -> Floats:
        """The values (count,) in the form that `at` and `gridded` read."""

    def at(self, field: Floats, points: Floats) -> Floats:
        """Interpolated values (k,) of a filled field at points (k, 3) [m]."""

    def gridded(self, field: Floats) -> Floats:
        """Values (nz, ny, nx) of a filled field at the centers of a grid's cells, with a layer of cells around."""


class Exchange(Record):
    """What crosses a boundary in proportion to a difference: coefficient (outside - c) a second and square meter."""

    coefficient: Annotated[float, Quantity(dim.VELOCITY)] = field("How well it crosses.", at_least=0)
    outside: VALUE | None = field("The value outside; by default 0.", None)


class Picture(Record):
    """A field from the brightness of a picture that covers the box around the domain in x and y."""

    file: kinds.File = field("Path of the picture, inside the scene's folder.")
    black: kinds.FixedScalar = field("The field where it is black, in SI.", "0")
    white: kinds.FixedScalar = field("The field where it is white, in SI.", "1")


class Part(Record):
    """What holds on a part of the boundary: one of value, flux, robin, periodic, open."""

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("type", "kind", "condition", "bc"),
        "what it has says so: `{value: 300}`, or `{flux: 5}`; where nothing is said, nothing crosses",
    )

    value: VALUE | None = field("The value there (Dirichlet).", None)
    flux: FLUX | None = field("What comes in a second and square meter, D dc/dn outwards (Neumann).", None)
    robin: Exchange | None = field("Exchange with the outside (Robin).", None)
    periodic: bool = field("The sides of this direction are one: what leaves here comes in at the other.", False)
    open: bool = field("A drift goes through: out with what it carries, in with nothing.", False)
    where: PLACE | None = field("Only where this formula is above 0.", None)
    near: SIZES | None = field("Only around this place, of two or three numbers.", None)
    within: kinds.FixedLength | None = field("How far around it.", None, above=0)

    def problems(self) -> Iterable[Problem]:
        """Problems: not exactly one condition; `periodic` on a part of a side; `near` without `within`."""
        given = [self.value is not None, self.flux is not None, self.robin is not None, self.periodic, self.open]
        if sum(given) != 1:
            yield Problem("a part of the boundary has one of `value`, `flux`, `robin`, `periodic` and `open`")
        if self.periodic and self.chosen:
            yield Problem("`periodic` holds on whole sides, without `where` or `near`")
        if (self.near is None) != (self.within is None) or (self.near is not None and len(self.near) not in (2, 3)):
            yield Problem("`near` is a place of two or three numbers, and goes with `within`")

    @property
    def chosen(self) -> bool:
        """Whether the part is restricted by `where` or `near`."""
        return self.where is not None or self.near is not None

    @property
    def span(self) -> Span | None:
        """Place of the part in the script, known from its formulas; None without any."""
        outside = None if self.robin is None else self.robin.outside
        formulas = (self.value, self.flux, self.where, outside)
        return next((one.span for one in formulas if one is not None), None)


Boundary = dict[str, Part]


def number_in(formula: Formula | None) -> float | None:
    """The value of a constant formula; None for a formula that varies, or no formula."""
    if formula is None or any(isinstance(node, Symbol | Link) for node in walk(formula.expr)):
        return None
    return float(evaluate(formula.expr, {}))


SAMPLES = {2: 24, 3: 8}
"""Samples of a formula along each side of a 2D or 3D box, before the run."""


def largest_in(formula: Formula | None, corner: Sequence[float], size: Sequence[float]) -> float | None:
    """Largest magnitude of a formula in a box at the start, from samples; None if it reads the field or other parts."""
    if formula is None or any(
        isinstance(node, Link) or (isinstance(node, Symbol) and node.name == "c") for node in walk(formula.expr)
    ):
        return None
    count, most = SAMPLES[len(size)], 0.0
    sides = [[low + side * k / count for k in range(count + 1)] for low, side in zip(corner, size, strict=True)]
    for place in product(*sides):
        known = {Symbol("x"): 0.0, Symbol("y"): 0.0, Symbol("z"): 0.0, **{Symbol(one): 0.0 for one in TIME}}
        known |= {Symbol(axis): x for axis, x in zip("xyz", place, strict=False)}
        most = max(most, abs(float(evaluate(formula.expr, known))))
    return most


def spacing_of(medium: Spaced, scene: StaticScene) -> tuple[float, ...]:
    """Sides [m] of a model's cells: exact for a box, the largest allowed for an object as domain."""
    if medium.size is not None:
        return tuple(side / n for n, side in zip(counts(medium.size, medium.cell), medium.size, strict=False))
    domain = None if medium.domain is None else scene.objects.get(medium.domain.name)
    flat = medium.flat or (domain is not None and type(domain).domain is not kinds.Object.domain)
    return (medium.cell,) * (2 if flat else 3)


class Medium(Model):
    """A domain on a grid of cells."""

    has_bodies = False
    is_field = True
    measures: ClassVar[tuple[str, ...]] = ()
    """Outputs besides MEASURES, as which no probe may be called."""

    domain: kinds.ObjectRef | None = field(
        "The object whose inside, at the start, it spreads in; or give `size`.", None
    )
    flat: bool = field("The section of that object at z = 0 alone.", False)
    edges: Literal["cut_cell", "staircase"] = field(
        "How cells meet the object's boundary: cut by it, or whole where their centers lie inside.", "cut_cell"
    )
    size: SIZES | None = field(
        "Sides of a box in place of a domain: two for a flat one, three for a deep one.", None, above=0
    )
    corner: SIZES | None = field("Low corner of that box; by default the origin.", None)
    depth: kinds.FixedLength = field("How thick a flat domain is.", "1 m", above=0)
    cell: kinds.FixedLength = field("Largest side of a cell.", above=0)
    probes: dict[str, SIZES] = field(
        "Places by name: the value of the cell there is an output of that name, which other parts may read while all "
        "is solved together.",
        {},
    )

    def insides(self) -> Iterable[kinds.Ref]:
        """The object that is its domain, if any."""
        return () if self.domain is None else (self.domain,)

    def shown_in_place_of(self) -> Iterable[kinds.Ref]:
        """The object that is its domain, if any."""
        return self.insides()

    def boundaries(self) -> Iterable[Boundary]:
        """The boundary conditions of every field."""
        raise NotImplementedError

    def probed(self) -> Iterable[Probed]:
        """Probes in an object's domain; they may lie outside by a cell, since cut cells have values."""
        if self.domain is not None:
            for name, place in self.probes.items():
                yield Probed(("probes", name), place, self.domain, self.cell)

    def problems(self) -> Iterable[Problem]:
        """Problems of domain, cells, formulas, probes and names of boundary parts."""
        if (self.size is None) == (self.domain is None):
            yield Problem("it spreads in one of the two: a box, `size: 1 1 m`, or an object, `domain: plate`")
        yield from misnamed(self.probes, (*MEASURES, *self.measures))
        if self.cell < SHORTEST:
            yield Problem(f"a cell is at least {SHORTEST:g} m", ("cell",), code="out-of-range")
            return
        if self.size is None:
            return
        if len(self.size) not in (2, 3) or (self.corner is not None and len(self.corner) != len(self.size)):
            yield Problem("a domain has two or three sides, and its corner as many numbers")
            return
        if min(self.size) < SHORTEST:
            yield Problem(f"a side is at least {SHORTEST:g} m", ("size",), code="out-of-range")
            return
        corner = self.corner or (0.0,) * len(self.size)
        if wrong := too_far(corner, self.cell):
            yield Problem(wrong, ("corner",), code="out-of-range")
        yield from outside(self.probes, corner, self.size)
        shape = counts(self.size, self.cell)
        cells = shape[0] * shape[1] * shape[2]
        if cells > MOST_CELLS:
            text = f"{cells:.3g} cells: at most {MOST_CELLS:,} are possible; take a larger `cell`"
            yield Problem(text, code="limit-refused")
        known = (*SIDES[: 2 * len(self.size)], "rest")
        for name in dict.fromkeys(
            name
            for boundary in self.boundaries()
            for name, part in boundary.items()
            if name not in known and not part.chosen
        ):
            text = f"the boundary has no side '{name}': it has {', '.join(known)}; or say `where` or `near`"
            yield Problem(text, ("boundary", name), at_key=True, help=suggestion(name, known))

    def sums_up(self, output: str) -> bool:
        """Whether an output is a field's total inflow, an integral over time."""
        return output.rpartition(".")[2] == "inflow"

    def must_hold_probes(self, layout: FieldLayout, assembly: Assembly) -> None:
        """Raise ScriptError for a probe that lies in no cell of the domain."""
        volumes = assembly.numbers(layout.volumes_at, layout.volumes_at + layout.count)
        for name, place in self.probes.items():
            cell = layout.cell(place)
            if cell < 0 or not volumes[cell] > 0.0:
                raise ScriptError(
                    [Diagnostic("probe-outside", f"the probe '{name}' stands outside the domain", assembly.line())]
                )

    def measure(self, what: str, layout: FieldLayout, state: ModelState) -> Any:
        """A measure of a field: `field` (cells,) and `centers` (cells, 3) of the domain, else a number or a probe."""
        import numpy as np

        field = state.y[layout.at : layout.at + layout.count]
        volumes = state.floats[layout.volumes_at : layout.volumes_at + layout.count]
        inside = volumes > 0.0
        match what:
            case "field":
                return field[inside]
            case "centers":
                return layout.centers()[inside]
            case "mass":
                return float(volumes @ field)
            case "inflow":
                return float(state.y[layout.at + layout.count])
            case "max":
                return float(field[inside].max())
            case "min":
                return float(field[inside].min())
            case "mean":
                return float(np.average(field, weights=volumes))
        return float(field[layout.cell(self.probes[what])])

    def places_of(self, what: str, layout: FieldLayout, state: ModelState) -> NDArray[int64] | None:
        """Indices in y of a measure of a field; None for one that is computed (kinds.Model.places)."""
        import numpy as np

        if what == "field":
            volumes = state.floats[layout.volumes_at : layout.volumes_at + layout.count]
            return layout.at + np.flatnonzero(volumes > 0.0)
        if what == "inflow":
            return np.array(layout.at + layout.count)
        return np.array(layout.at + layout.cell(self.probes[what])) if what in self.probes else None


def gives_of(field: str, unit: Dimension, written: Mapping[str, Any]) -> Mapping[str, Gives]:
    """The outputs of `measure` for a field of a unit; ``field``: the field's description in the manual."""
    probes = written.get("probes")
    one, amount = quantity_type(unit), quantity_type(unit * dim.VOLUME)
    return {
        "field": Gives(quantity_type(unit, (None,)), field),
        "centers": Gives(quantity_type(dim.LENGTH, (None, 3)), "The centers of these cells.", computed=True),
        "mass": Gives(amount, "How much there is: the field over the volume.", computed=True),
        "inflow": Gives(amount, "How much has come in through the boundary and from sources since the start."),
        "max": Gives(one, "Largest value.", computed=True),
        "min": Gives(one, "Least value.", computed=True),
        "mean": Gives(one, "Mean over the volume.", computed=True),
        **{
            name: Gives(one, "The value of the cell there.")
            for name in map(str, probes if isinstance(probes, Mapping) else ())
        },
    }


def layout_of(at: int, ints: tuple[int, ...], floats: Floats) -> FieldLayout:
    """The layout of a field at ``at`` in y; ``ints``: offsets of volumes and box in the floats, nx, ny, nz."""
    volumes_at, box_at, nx, ny, nz = ints[:5]
    box = floats[box_at : box_at + 6]
    return FieldLayout((nx, ny, nz), at, volumes_at, tuple(box[:3].tolist()), tuple(box[3:].tolist()))
