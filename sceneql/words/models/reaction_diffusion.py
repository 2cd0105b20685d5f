"""reaction_diffusion: several species that spread through a domain and react, by formulas of the script."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

from sceneql.formulas.formula_rows import TIMES, Rows
from sceneql.grids.medium import SOURCE, Boundary, FieldLayout, gives_of, layout_of
from sceneql.grids.spreading_medium import COEFFICIENT, SpreadingMedium
from sceneql.kinds import Formula, Gives, Problem, Record, Symbols, Value, field
from sceneql.kinds.stable_step import Oscillation, StaticScene
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Link, Number, Symbol, Type, recursive, walk

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.grids.ground import Ground
    from sceneql.system import Assembly, ModelState

PLACES = ("x", "y", "z")
OWN = "c"


class Species(Record):
    """One field: how it spreads, where it starts, how fast it is made."""

    coefficient: COEFFICIENT | None = field(
        "The coefficient D [m^2/s] of its spread; by default it stays in place, whatever drifts.", None
    )
    initial: Annotated[Formula, Symbols(None, dim.PLAIN, of_field=True)] | None = field(
        "The field at the start, by place; by default 0.", None
    )
    rate: Annotated[Formula, Symbols(None, dim.FREQUENCY, of_field=True)] | None = field(
        "What the reactions make of it a second, by place, time and all species.", None
    )
    source: SOURCE | None = field("What comes in besides, a second and cubic meter.", None)
    boundary: Boundary | None = field("What holds on the boundary for it; by default the model's.", None)

    @property
    def made(self) -> bool:
        """Whether it reacts or has a source."""
        return self.rate is not None or self.source is not None

    @property
    def positive(self) -> bool:
        """A species may stand for anything."""
        return False


class ReactionDiffusion(SpreadingMedium):
    """Reaction and diffusion of species: dc_i/dt = div(D_i grad c_i) + f_i(c_1, c_2, ..., x, y, z, t).

    The rates f_i are formulas in which the species stand by their names and `where` by its own; x, y, z and t (or
    `time`) are plain numbers in SI, and so are the species. They are compiled to one pass over all cells, by their
    form: other numbers compile nothing. The Jacobian is derived symbolically, so every implicit solver has it. Cells,
    boundaries and spread are those of `diffusion`; a reaction that makes as much of one species as it takes of another
    keeps their sum to rounding. Sources: Turing (1952), Phil. Trans. R. Soc. B 237, 37-72; Murray, Mathematical
    Biology II (2003), chapter 2; Pearson (1993), Science 261, 189-192 (the Gray-Scott system).

    Outputs of a species `u`: `u` (in every cell), `u.mass`, `u.inflow` (through the boundary and by reactions),
    `u.max`, `u.min`, `u.mean`; and `centers` of the cells.
    """

    species: dict[str, Species] = field("The fields by name: `{u: {coefficient: 2e-5, initial: 1, rate: -u*v^2}}`.")
    where: dict[str, Formula] = field("Quantities that rates and starts use, each evaluated once a cell.", {})
    boundary: Boundary = field("What holds on the boundary, as for `diffusion`, for species without their own.", {})

    @classmethod
    def formula_symbols(cls, written: Mapping[str, Any]) -> tuple[str, ...]:
        """Species, helper quantities, place and time."""
        return (*_names(written, "species"), *_names(written, "where"), *PLACES, *TIMES)

    @classmethod
    def formula_dimension(cls, written: Mapping[str, Any]) -> Dimension | None:
        """Species are plain numbers."""
        return dim.PLAIN

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of every species."""
        found: dict[str, Gives] = {}
        for name in _names(written, "species"):
            of_one = dict(gives_of(f"The field {name} in every cell of the domain.", dim.PLAIN, written))
            found["centers"] = of_one.pop("centers")
            found[name] = of_one.pop("field")
            found |= {f"{name}.{what}": gives for what, gives in of_one.items()}
        return found

    @cached_property
    def rows(self) -> Rows:
        """The rates without their places in the script."""
        zero = Number(0.0)
        return Rows(
            start=dict.fromkeys(self.species, zero),
            rate={name: zero if one.rate is None else one.rate.expr for name, one in self.species.items()},
            where={name: formula.expr for name, formula in self.where.items()},
            invariants={},
            gives={},
            index=None,
        )

    def problems(self) -> Iterable[Problem]:
        """Names that mean two things, formulas that are not one number, circles."""
        if not self.species:
            yield Problem("there is nothing to spread: name a species", ("species",))
            return
        yield from super().problems()
        for field_name, names in (("species", self.species), ("where", self.where)):
            for name in names:
                if name in (*PLACES, OWN, "centers") or not name.isidentifier():
                    why = "is a coordinate" if name in PLACES else "cannot be a name in formulas"
                    why = "stands for the places of the cells" if name == "centers" else why
                    why = "stands for each species in its own coefficient" if name == OWN else why
                    yield Problem(f"'{name}' {why}: take another name", (field_name, name), at_key=True)
        told = False
        for problem in self.rows.problems():
            told = True
            row, *rest = problem.path
            path = problem.path if row == "where" else ("species", *rest)
            path = (*path, "rate") if row == "rate" and rest else path
            yield Problem(problem.text, path, problem.at_key, problem.code)
        for start, formula in () if told else self._starts().items():
            links = [f"{node.task}.{node.output}" for node in walk(formula.expr) if isinstance(node, Link)]
            symbols = [node.name for node in walk(formula.expr) if isinstance(node, Symbol)]
            for unknown in (*links, *(name for name in symbols if name not in PLACES)):
                yield Problem(f"'{unknown}' has no value before the start", ("species", start, "initial"))
                break

    def _starts(self) -> dict[str, Formula]:
        """Formulas of the fields at the start, with the quantities of `where` substituted."""
        given = {name: one.initial for name, one in self.species.items() if one.initial is not None}
        meanings = {name: formula.expr for name, formula in self.where.items()}
        return {name: Formula(_written_out(one.expr, meanings), one.span) for name, one in given.items()}

    def boundaries(self) -> Iterable[Boundary]:
        """Those of its species."""
        return [self.boundary if one.boundary is None else one.boundary for one in self.species.values()]

    def coefficients(self) -> Iterable[tuple[Formula | None, tuple[str, ...]]]:
        """Those of its species."""
        return [(one.coefficient, ("species", name, "coefficient")) for name, one in self.species.items()]

    def fastest(self, name: str, scene: StaticScene) -> Iterable[Oscillation]:
        """What limits the explicit step of each species' spread; what reactions add is not known before the run."""
        found = [self.spreading(one.coefficient, scene) for one in self.species.values()]
        return [one for one in found if one is not None]

    def assemble(self, name: str, assembly: Assembly) -> None:
        """Reserve every species' cells and inflow, and add their spread and reactions. Raises ScriptError."""
        from sceneql.formulas.rate_program import RateSystem
        from sceneql.grids.assembly import add_field
        from sceneql.grids.domain.domain import cells_of
        from sceneql.grids.ground import Ground
        from sceneql.grids.reaction_program import add_reaction

        ground = Ground(cells_of(self, assembly), assembly)
        fields = []
        starts = self._starts()
        for (name, one), boundary in zip(self.species.items(), self.boundaries(), strict=True):
            drift = None if one.coefficient is None else self.drift
            own = one.model_copy(update={"initial": starts.get(name)})
            grid = add_field(own, boundary, drift, ground, assembly)
            assembly.offer(name, grid)
            fields.append(grid.at)
        rows = self.rows
        self._must_be_finite(ground, fields, assembly)
        if any(one.rate is not None for one in self.species.values()):
            system = RateSystem(tuple(rows.states), tuple(rows.rates()), rows.where)
            add_reaction(system, ground, fields, assembly)
        assembly.remember(*ground.memory, *fields)
        self.must_hold_probes(layout_of(fields[0], ground.memory, assembly.numbers()), assembly)

    def _must_be_finite(self, ground: Ground, fields: list[int], assembly: Assembly) -> None:
        """Raise ScriptError for a rate that is not finite in a cell at the start."""
        import numpy as np

        known: dict[str, Any] = dict.fromkeys(TIMES, 0.0)
        known |= dict(zip(PLACES, ground.centers[ground.inside].T, strict=True))
        start = assembly.start()
        for name, at in zip(self.species, fields, strict=True):
            known[name] = start[at : at + ground.count][ground.inside]
        look_up = self.rows.look_up(known, lambda link: assembly.initial(Value(link)), arrays=True)
        for name, one in self.species.items():
            if one.rate is None:
                continue
            try:
                with np.errstate(all="ignore"):
                    rate = np.asarray(evaluate(one.rate.expr, look_up, arrays=True))
            except ScriptError:
                continue  # it reads a solved state that has no place in y yet
            rate = np.broadcast_to(rate, ground.inside.sum())
            bad = np.flatnonzero(~np.isfinite(rate))
            if len(bad):
                x, y, z = ground.centers[ground.inside][bad[0]]
                text = f"the rate of {name} has no finite value at the start at ({x:g}, {y:g}, {z:g}) m"
                raise ScriptError([Diagnostic("not-finite", text, one.rate.span)])

    def connect(self, name: str, assembly: Assembly) -> None:
        """Add the drift by a flow that is solved. Raises ScriptError."""
        if self.drift is None or self.drift.by is None:
            return
        from sceneql.flows.carried import carry

        for species, one in self.species.items():
            grid = assembly.field_of(Link(name, species, Type((None,))))
            if grid is not None:
                boundary = self.boundary if one.boundary is None else one.boundary
                carry(self, self.drift, [(grid, boundary)], assembly)

    def field_count(self) -> int:
        """One a species."""
        return len(self.species)

    def layout(self, state: ModelState, output: str) -> FieldLayout:
        """Where the field of a species lies, for pictures; ``output``: its name."""
        at = state.ints[5 + list(self.species).index(output)]
        return layout_of(at, state.ints, state.floats)

    def shows(self, name: str) -> Value | None:
        """Its first species."""
        return Value(Link(name, next(iter(self.species)), Type((None,))))

    def read(self, output: str, state: ModelState) -> Any:
        """An output: (cells of the domain,), (cells, 3) or float."""
        if output == "centers":
            return self.measure(output, self.layout(state, next(iter(self.species))), state)
        name, _, what = output.partition(".")
        return self.measure(what or "field", self.layout(state, name), state)

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the cells of a species, of probes, and of what has come in."""
        name, _, what = output.partition(".")
        return None if name not in self.species else self.places_of(what or "field", self.layout(state, name), state)


def _written_out(expr: Expr, meanings: Mapping[str, Expr]) -> Expr:
    """Formula with symbols replaced by their expressions."""

    def step(node: Expr) -> Generator[Expr, Expr, Expr]:
        if isinstance(node, Symbol) and node.name in meanings:
            return (yield meanings[node.name])
        if not isinstance(node, Call):
            return node
        args = []
        for arg in node.args:
            args.append((yield arg))
        return replace(node, args=tuple(args))

    found: Expr = recursive(step, expr)
    return found


def _names(written: Mapping[str, Any], field_name: str) -> tuple[str, ...]:
    """Keys of a mapping in the script; its problems are reported later."""
    item = written.get(field_name)
    return tuple(map(str, item)) if isinstance(item, Mapping) else ()
