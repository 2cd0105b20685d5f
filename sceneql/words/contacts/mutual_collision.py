"""mutual_collision: masses collide with one another, as spheres."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from sceneql.contacts import tallies
from sceneql.kinds import Contact, DrawnRef, FixedLength, Gives, Model, Problem, Ref, Scalar, field
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Type

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, ModelState, Slopes

MOST_EXACT = 8
EXACT = "sceneql.contacts.mutual.sphere_events_kernels"
LOCAL = "sceneql.contacts.mutual.sphere_back_off_kernels"
MOST_DIFFERENCES = 30
"""Largest number of masses for which implicit solvers difference the forces between resting masses, in mode `exact`."""
SPRINGS, OVERLAPS = 5, 6
"""Places after the tally: numbers of excluded pairs, those tied by springs and those that overlap at the start."""
FEW = 300
"""Largest number of masses for which all pairs are tested: that takes less time than importing scipy's trees."""


class MutualCollision(Contact):
    """Impacts and resting contact of masses with one another: spheres of their radii, which do not turn.

    An impact turns the normal part of the relative velocity round, scaled by the restitution (Newton 1687), with an
    impulse of Coulomb's friction across it; the momentum stays. Mode `exact` locates every impact to rounding and
    restarts the solver there, for elastic masses; `local` finds the impacts of a step by cell lists (Hockney & Eastwood
    1981), first ones first, and lets masses that approach no faster than they are pressed rest on each other and on the
    objects, by impulses at the end of the step (Moreau 1988); `auto` is exact for up to 8 elastic masses.

    In mode `local` masses that a spring ties, and masses of one net that overlap at the start by more than rounding,
    do not collide: so a cloth or a rope lies on itself, each mass a sphere as wide as the cloth is thick. `explain`
    counts these pairs. Its layers cannot pass through each other where the thickness is no less than the side of a
    cell. Steps that a tolerance chooses are at most 1/240 s there; masses that are not elastic rest where they approach
    slower than what presses them gives in two.

    Mode `barrier` is that of `collision` with elastic solids, for cloth and solids of springs alone: their faces are
    pushed off themselves, one another and the objects within the `gap`, and nothing passes in any step of any solver.
    It has no restitution, the radius of masses does not count, and no other contact may move these masses.
    """

    mutual: ClassVar[bool] = True
    gives: ClassVar[Mapping[str, Gives]] = {"hits.count": Gives(Type(), "Number of impacts so far.")}

    between: tuple[DrawnRef, ...] | None = field(
        "The models whose masses collide, and the objects that these rest on; by default all models with masses and "
        "all objects with an inside that follow no model that is solved.",
        None,
    )
    restitution: Scalar = field("Normal speed after an impact as a part of that before.", "0.5", at_least=0, at_most=1)
    friction: Scalar = field("Coulomb's coefficient of friction.", "0", at_least=0)
    mode: Literal["auto", "exact", "local", "barrier"] = field("How impacts are found.", "auto")
    gap: FixedLength | None = field(
        "Distance from which on mode `barrier` pushes faces off; by default a twentieth of their mean side.",
        None,
        above=0,
    )

    def ties(self) -> tuple[Ref, ...]:
        """The models and objects of `between`."""
        return self.between or ()

    def problems(self) -> Iterator[Problem]:
        """A restitution where there is none, and a gap that nothing has."""
        if self.mode == "barrier" and self.restitution.span is not None:
            yield Problem("mode barrier has no restitution: springs throw off", ("restitution",), at_key=True)
        if self.mode != "barrier" and self.gap is not None:
            yield Problem("spheres have no gap: mode barrier has", ("gap",), at_key=True)

    def keeps_apart(self, models: Mapping[str, Model]) -> bool:
        """In mode `barrier`."""
        return self.mode == "barrier"

    def refusals(self, models: Mapping[str, Model]) -> Iterator[Diagnostic]:
        """Rigid bodies, which turn: `collision` is their word, with the names to write; and what a barrier lacks."""
        rigid = [name for name, model in models.items() if model.turns]
        if not rigid:
            yield from self._without_faces(models)
            return
        message = f"'{rigid[0]}' is rigid, and `mutual_collision` is of masses, which do not turn"
        touched = dict.fromkeys(rigid + [ref.name for ref in self.between or () if ref.name not in models])
        help = f"write `collision: {{between: [{', '.join(touched)}]}}`"
        if len(rigid) < len(models):
            help += " for what is rigid, and name the masses alone here, under `between`"
        written = next((ref.span for ref in self.between or () if ref.name == rigid[0]), None)
        yield Diagnostic("no-collider", message, written, help)

    def _without_faces(self, models: Mapping[str, Model]) -> Iterator[Diagnostic]:
        """The first model of mode `barrier` that is no net with faces."""
        whys = {name: model.faceless() for name, model in models.items()} if self.mode == "barrier" else {}
        hard = next((name for name, why in whys.items() if why), None)
        if hard is not None:
            from sceneql.contacts.barrier.refused import beside_solids

            written = next((ref.span for ref in self.between or () if ref.name == hard), None)
            if models[hard].has_skin:
                text = f"'{hard}' is elastic, and has a barrier in `collision`"
                yield Diagnostic("no-collider", text, written, "write `collision` with the same names")
            else:
                yield beside_solids(hard, whys[hard], written, "in mode `barrier`")

    def assemble_carried(
        self,
        name: str,
        assembly: Assembly,
        skins: Sequence[str],
        carried: Sequence[Bodies],
        everyone: Sequence[Bodies],
        others: tuple[Ref, ...],
    ) -> None:
        """Raises ScriptError: a flow keeps apart what it carries."""
        from sceneql.quantities.diagnostic import Diagnostic, ScriptError

        text = f"masses of '{carried[0].model}' move as their flow does, which keeps them apart: they have no impacts"
        raise ScriptError([Diagnostic("no-collider", text, assembly.line(), "name under `between` others alone")])

    def assemble_together(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> None:
        """Add the contacts of all pairs. Raises ScriptError for masses that start inside each other."""
        if self.mode == "barrier":
            from sceneql.contacts.barrier import barrier_contact

            touched = [Ref(ref.name, assembly.line()) for ref in others]
            told = barrier_contact.assemble(assembly, everyone, touched, self.friction, self.gap)
            assembly.remember(*told)
            return
        import numpy as np

        from sceneql.bodies.neighbors import table
        from sceneql.contacts.colliders import OFTEN, surfaces
        from sceneql.contacts.mutual.sphere_pair_kernels import BODY, HEAD, INSTANT, MOST_WARM, PAIR

        rows = [
            (
                at.position_at + 3 * k,
                at.velocity_at + 3 * k,
                at.work_at,
                at.mass_at + k,
                at.inverse_at + k,
                at.radius_at + k,
            )
            for at in everyone
            for k in range(at.count)
        ]
        n = len(rows)
        elastic = self.restitution.constant and float(assembly.initial(self.restitution)) == 1.0
        if self.mode == "exact" and not elastic:
            text = "exact collisions between masses are elastic: those that lose speed come to rest on each other"
            raise ScriptError([Diagnostic("not-elastic", text, assembly.line(), "set restitution: 1 or mode: local")])
        exact = self.mode == "exact" or (self.mode == "auto" and elastic and n <= MOST_EXACT)
        tied, by_springs = _tied(assembly, everyone, exact)
        size, first, second = table(n)
        tally = assembly.floats([0.0, np.nan, np.nan, 0.0, np.nan, by_springs, len(tied) - by_springs])
        objects = surfaces([Ref(ref.name, assembly.line()) for ref in others], assembly, HEAD + BODY * n)
        pairs = n * (n - 1) // 2
        scratch = (3 * n, 3 * n, n, size + 1) if not exact else (INSTANT * n, PAIR * pairs, 0, 0)
        ints = (
            *(n, assembly.value(self.restitution), assembly.value(self.friction), tally),
            *(assembly.floats(np.full(count, np.nan if exact and not k else 0.0)) for k, count in enumerate(scratch)),
            *(size, first, second, len(others)),
            HEAD + BODY * n + len(objects) if len(tied) else 0,
            0 if exact else assembly.floats(np.zeros(3 + (4 + 4 * MOST_WARM) * n)),
            *(number for row in rows for number in row),
            *objects,
        )
        ints = (*ints, *_partners(tied, n, len(ints)))
        if exact:
            kernels = (f"{EXACT}:gap", f"{EXACT}:impact")
            assembly.contact("exact", kernels, ints, pairs)
            assembly.term("constrain", f"{EXACT}:constrain", ints, None if n <= MOST_DIFFERENCES else _no_slopes)
        else:
            assembly.step_at_most(OFTEN)
            assembly.contact("local", (f"{LOCAL}:back_off",), ints, 0)
            assembly.term("close", f"{LOCAL}:store_free", ints, _no_slopes)
        assembly.remember(tally)

    def read(self, output: str, state: ModelState) -> Any:
        """The number of impacts; a barrier has none."""
        if self.mode == "barrier":
            return 0.0
        return float(sum(state.floats[at] for at in state.ints))

    def remark(self, state: ModelState) -> str:
        """How many pairs do not collide, and why; the gap of a barrier."""
        if self.mode == "barrier":
            return tallies.remark(state)
        springs, overlaps = (int(sum(state.floats[at + k] for at in state.ints)) for k in (SPRINGS, OVERLAPS))
        if not springs + overlaps:
            return ""
        why = (f"{springs} that springs tie" if springs else "", f"{overlaps} that overlap at the start")
        return f"left out: pairs of one net, {' and '.join(filter(None, why if overlaps else why[:1]))}"


def _tied(assembly: Assembly, everyone: Sequence[Bodies], exact: bool) -> tuple[NDArray[int64], int]:
    """Pairs (m, 2) that do not collide, lower number first, and how many of them springs tie.

    They are pairs tied by a spring, and pairs of one net that overlap at the start. In mode `exact` there are none.
    Raises ScriptError for any other two moving masses that overlap.
    """
    import numpy as np

    from sceneql.contacts.mutual.sphere_pair_kernels import TOUCHING

    y, floats = assembly.start(), assembly.numbers()
    tied = {} if exact else {k: at.springs.ends for k, at in enumerate(everyone) if at.springs is not None}
    model = np.repeat(np.arange(len(everyone)), [at.count for at in everyone])
    places = np.concatenate([y[at.position_at : at.position_at + 3 * at.count] for at in everyone]).reshape(-1, 3)
    radii = np.concatenate([floats[at.radius_at : at.radius_at + at.count] for at in everyone])
    moving = np.concatenate([floats[at.inverse_at : at.inverse_at + at.count] for at in everyone]) > 0.0
    pairs = np.sort(_near(places, 2.0 * float(radii.max(initial=0.0))), axis=1)
    depth = radii[pairs].sum(axis=1) - np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1)
    own = (model[pairs[:, 0]] == model[pairs[:, 1]]) & np.isin(model[pairs[:, 0]], tuple(tied))
    wrong = np.where(moving[pairs].all(axis=1) & ~own, depth, 0.0)
    rounding = TOUCHING * radii.max(initial=0.0)
    if len(pairs) and wrong.max() > rounding:
        worst = int(np.argmax(wrong))
        names = [f"mass {k} of '{bodies.model}'" for bodies in everyone for k in range(bodies.count)]
        one, other = (names[k] for k in pairs[worst])
        text = f"{one} and {other} overlap by {wrong[worst]:.3g} m at the start"
        raise ScriptError(
            [Diagnostic("masses-overlap", text, assembly.line(), "move them apart, or make them smaller")]
        )
    none = np.empty((0, 2), dtype=np.int64)
    springs = [np.sort(ends, axis=1) + np.searchsorted(model, k) for k, ends in tied.items()]
    by_springs = np.unique(np.concatenate([none, *springs]), axis=0)
    return np.unique(np.concatenate([pairs[own & (depth > rounding)], by_springs]), axis=0), len(by_springs)


def _no_slopes() -> Slopes:
    """Derivatives of a term that adds nothing, or hardly ever: none."""
    import numpy as np

    from sceneql.system import Slopes

    none = np.empty(0, dtype=np.int64)
    return Slopes(f"{EXACT}:constrain", none, none)


def _partners(tied: NDArray[int64], count: int, start: int) -> tuple[int, ...]:
    """Integers of the pairs ``tied`` (m, 2) of ``count`` masses (sphere_pair_kernels), to stand at ``start``."""
    import numpy as np

    if not len(tied):
        return ()
    firsts = start + count + 1 + np.searchsorted(tied[:, 0], np.arange(count + 1))
    return (*firsts.tolist(), *tied[:, 1].tolist())


def _near(places: Floats, reach: float) -> NDArray[int64]:
    """Pairs (m, 2) of places (n, 3) no further apart than ``reach`` [m]; all pairs of up to FEW places."""
    import numpy as np

    if len(places) <= FEW:
        return np.column_stack(np.triu_indices(len(places), 1))
    from scipy.spatial import cKDTree

    found: NDArray[int64] = cKDTree(places).query_pairs(reach, output_type="ndarray")
    return found
