"""collision: masses and rigid bodies bounce off, slide on and rest on objects."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from sceneql.contacts import layout, tallies
from sceneql.kinds import (
    Contact,
    DrawnRef,
    FixedLength,
    Gives,
    Length,
    Model,
    Problem,
    Ref,
    Scalar,
    field,
    quantity_type,
)
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Type

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, ModelState, Slopes

MOST_EXACT = 8
EXACT = "sceneql.contacts.collision_kernels"
NO_RESTITUTION = "elastic solids have no restitution: they bounce by their own elasticity"
NODES = "leave it out; mode `local` has one, of the nodes as masses"
LOCAL = "sceneql.contacts.back_off_kernels"
SHAPES = "sceneql.contacts.shapes"
MOST_CUT = 4096
"""Number of bodies above which no step is cut at an impact: the search costs more than it gains."""


class Collision(Contact):
    """Impacts and resting contact of masses with objects of any shape; the radius of a mass counts.

    An impact turns the normal velocity round, scaled by the restitution (Newton 1687), with an impulse of Coulomb's
    friction across it; a resting mass feels the normal force that keeps it outside and Coulomb's friction (1785). The
    kinetic energy that is lost is counted as dissipated. Mode `exact` locates every impact to rounding and restarts
    the solver there, up to the end of infinitely many bounces; `local` backs each mass off to its own impact within
    the step, for very many; `auto` is exact for up to 8 masses. Implicit Runge-Kutta methods and bdf2 have `local`
    contacts within their stages: a mass that touches ends the step on the surface whatever its springs do.

    Planes, spheres, boxes and closed meshes have exact distances. Any other object with an inside is touched where its
    field is zero; a mass with a radius at that distance from it, but in front of the sharp edges of combined solids,
    where it is the field over its slope. An object may move, but not change its shape. A fast mass sees what is thicker
    than a ten-thousandth of the object's size.

    Rigid bodies collide with one another and with objects, which may move by keys or formulas and so carry and push
    them. `auto` is mode `exact` for up to 8 bodies, where that takes all their shapes, ties and the solver (explicit,
    with steps that a tolerance chooses), and `explain` tells why if not; where it then finds no way on, or has taken
    more work than some steps of `local` in each 1/240 s, the run goes on from that instant in mode `local` and warns of
    it. In mode `local` the velocities at the end of a step, of all contacts together, obey Coulomb's law to rounding
    (Moreau 1988), so that what rests stays and nothing sinks, whatever the masses; places are of order 1 in the step.
    Spheres, boxes, planes and convex meshes touch exactly. Any other shape with an inside (cylinders, rings, meshes,
    solids cut out of one another, implicit surfaces) touches by points of its surface, those of its edges and those of
    its smooth parts slid to where the two face each other, 20 cells along it and more where it is thin: details smaller
    than a cell on both are not seen, all else to a millionth of the size. Where a step would take such a shape farther
    than half its thickness it is cut; a pair has at most 12 points. Bodies may be held by ties, which are found with
    the contacts; those that a tie joins do not touch each other. `points`, `normals` and `forces` tell of it, hits and
    rest do not; those of mode `exact` stay as they were where `local` goes on.

    `rolling` is a length: the normal force makes, at that arm, the largest moment that resists rolling and spinning. A
    ball of radius r that rolls at v comes to rest after (7/10) v^2 r / (g rolling), what stands on a slope flatter than
    rolling / r stays. Masses do not turn, and have none.

    Mode `exact` is for few rigid bodies and what stands or moves by keys and formulas, for masses that strike them, and
    for ties with their stops, motors and friction. Spheres, boxes, planes and convex meshes touch one another, and are
    touched by ellipsoids (a sphere alone in a group with a scale), cylinders and tori, and balls by implicit and blobby
    surfaces: what rolls over these is exact. Of two curved ones one has to be a cylinder, which others meet by its
    round side; cylinders meet each other by round sides, rims and a rim on a flat end, and sharp edges by their rims.
    Two flat ends on each other have no exact contact. A cylinder or torus that lies flat stands and tips as if its
    whole circle were there, and has the friction of the points of it that are told; over an edge it stops the run, or
    `local` goes on, but for a column that lies along it. One that falls past the flat runs round its circle; what rocks
    hundreds of times a second, lower than 1/30,000 of its size, comes to lie. All contacts that approach are reflected
    together until none approaches (Smith et al. 2012), and what rests, rolls or slides has the forces of Coulomb's law,
    and the moments of `rolling`, at every stage of the solver, whose order it keeps. Bounces that are lower than a
    billionth of the body's size end at once, and those of a pair whose impacts crowd sooner: from a thousandth of it,
    or with no restitution left, so that what tips from corner to corner comes to rest. Impacts without end stop the run
    of a contact whose mode is named `exact` at its line. Many faces on one another, as in a pile or an arch that falls,
    take long.

    Elastic solids collide in mode `barrier`: their skins are pushed off within the `gap`, ever more the nearer, so that
    no node, and no middle of an edge between nodes, passes a surface in any step of any solver (Li et al. 2020). There
    is no restitution; friction is Coulomb's but below a slip of 0.01 % of the solids' size a second. An edge of an
    object that is sharper than the elements may enter between these places. Rigid bodies that collide with elastic
    solids do so by the barrier, too, and with one another and with objects there: by triangles of up to 3 sides of the
    skins, of a ball by 1,280 that lie within half a hundredth of its radius. What they keep apart is no smaller than
    the gap; friction acts on both sides of it, and so may turn them a little by that arm. `points`, `normals` and
    `forces` do not tell of the barrier, and bodies that ties hold do not collide with elastic solids. Cloth and
    `solid` nets of springs beside elastic solids have it on both sides of their faces, also against themselves, as in
    `touch: {collision: {between: [jelly, sheet, floor], friction: 0.3}}` of an `elastic` jelly on a `cloth`: the gap
    is then all the thickness that counts. What tears, ropes and particles are refused there.

    Skins in a flow (`membrane`) have no mass: within the `gap`, a cell by default, forces push them off objects,
    masses, rigid bodies, one another and themselves (what is nearer at the start than two gaps is not pushed apart),
    ever more the nearer, so that no vertex passes anything in any step; what they touch feels the same. There is no
    restitution: tension throws off. Friction on objects and bodies holds each vertex by a spring at the place where it
    came to touch, which slides along where it would pull more than Coulomb's law lets it (Cundall & Strack 1979), so
    that what sticks does not creep; between skins it grows with the slip until Coulomb's law holds it. An edge or
    corner thinner than the distance of vertices may enter between them. Objects that a skin collides with are no walls
    to the fluid unless the flow goes `around` them, too. Skins of a periodic flow do not touch across its ends.

    Steps that a tolerance chooses are at most 1/240 s in mode `local`, and where an object moves other than straight on
    at one speed. In mode `local` what lands slower than gravity makes it in two steps comes to rest, at 1/240 s below
    8 cm/s on Earth: smaller bounces need a solver of shorter steps, by `largest_step` or `step`, or mode `exact`.

    For example `touch: {collision: {restitution: 0.8, friction: 0.3}}`.
    """

    gives: ClassVar[Mapping[str, Gives]] = {
        "hits.count": Gives(Type(), "Number of impacts so far."),
        "hits.first.time": Gives(quantity_type(dim.TIME), "Time of the first impact; NaN before."),
        "hits.last.time": Gives(quantity_type(dim.TIME), "Time of the latest impact; NaN before the first."),
        "hits.last.speed": Gives(quantity_type(dim.VELOCITY), "Speed of approach of the latest impact."),
        "rest.time": Gives(quantity_type(dim.TIME), "When the bouncing came to its end; NaN before."),
        "points": Gives(quantity_type(dim.LENGTH, (None, 3)), "Where rigid bodies touch."),
        "normals": Gives(Type((None, 3)), "Unit normals there, towards the first body of each pair."),
        "forces": Gives(quantity_type(dim.FORCE, (None, 3)), "Forces there, on the first body of each pair."),
    }

    between: tuple[DrawnRef, ...] | None = field(
        "What collides: models and objects, as `[ball, floor]`; by default all models with masses and all objects with "
        "an inside that follow no model that is solved.",
        None,
    )
    restitution: Scalar = field("Normal speed after an impact as a part of that before.", "0.5", at_least=0, at_most=1)
    friction: Scalar = field("Coulomb's coefficient of friction.", "0", at_least=0)
    rolling: Length = field(
        "Length by which the normal force makes the largest moment that resists rolling and spinning, of rigid bodies.",
        "0 m",
        at_least=0,
    )
    thickness: FixedLength = field("Distance to keep besides the radius.", "0 m", at_least=0)
    mode: Literal["auto", "exact", "local", "barrier"] = field("How impacts are found.", "auto")
    gap: FixedLength | None = field(
        "Distance from which on elastic solids, and skins in flows, are pushed off; by default a twentieth of the "
        "sides of their elements' faces, and a cell of the flow.",
        None,
        above=0,
    )

    def trouble(self, state: ModelState) -> str:
        """Steps in which contacts of rigid bodies were more than can be told, or had no solution."""
        return tallies.trouble(state)

    def remark(self, state: ModelState) -> str:
        """The gap of skins."""
        return "" if self.mode in ("exact", "local") else tallies.remark(state)

    def read(self, output: str, state: ModelState) -> Any:
        """An output over all its models: counts add up, the first time is the earliest, the last the latest."""
        return tallies.read(output, state)

    def ties(self) -> tuple[Ref, ...]:
        """The models and objects of `between`."""
        return self.between or ()

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies, others: tuple[Ref, ...]) -> None:
        """Add the contacts of one model with the objects. Raises ScriptError for one that cannot be collided with."""
        import numpy as np

        from sceneql.compiled.compile_beside import compile_beside
        from sceneql.compiled.numba import lazy_kernels
        from sceneql.contacts.colliders import OFTEN, must_be_free, must_be_outside, surfaces
        from sceneql.contacts.impact_kernels import MOST_CUTS

        must_be_free(bodies.model, assembly)
        if self.mode == "barrier":
            message = f"mode `barrier` is that of elastic solids, and '{bodies.model}' is none"
            raise ScriptError([Diagnostic("no-collider", message, assembly.line(), "leave the mode out")])
        if not others:
            return
        exact = self.mode == "exact" or (self.mode == "auto" and assembly.body_count() <= MOST_EXACT)
        compile_beside(
            (EXACT if exact else LOCAL,)
        )  # the island's largest kernels, in parallel with those for the objects, which compile here

        touched = self._written(others)
        objects = surfaces(touched, assembly, layout.HEAD)
        if exact:
            compile_beside(one for one in lazy_kernels.modules() if one.startswith(f"{SHAPES}."))  # for every gap
        nan = float("nan")
        period = math.inf if bodies.springs is None else bodies.springs.period
        square = (2.0 * math.pi / period) ** 2 if period > 0.0 else math.inf
        cuts = (0.0, 0.0, 0.0) if assembly.body_count() <= MOST_CUT else (float("inf"), 0.0, MOST_CUTS)
        tally_at = assembly.floats([0.0, nan, nan, 0.0, nan])
        pairs = bodies.count * len(others)
        numbers = (
            assembly.value(self.restitution),
            assembly.value(self.friction),
            assembly.floats([self.thickness]),
            tally_at,
            assembly.floats(np.zeros(pairs * layout.PAIR)),
            assembly.floats(
                np.full(bodies.count * layout.INSTANT, nan)
                if exact
                else np.concatenate([cuts, np.zeros(1 + bodies.count), [square, 0.0]])
            ),
            len(others),
        )
        masses = (bodies.position_at, bodies.velocity_at, bodies.work_at, bodies.mass_at, bodies.inverse_at)
        ints = (*masses, bodies.radius_at, bodies.count, *numbers, *objects)
        must_be_outside(bodies.model, touched, ints, assembly)
        if exact:
            assembly.contact("exact", (f"{EXACT}:gap", f"{EXACT}:impact"), ints, pairs)
        else:
            assembly.step_at_most(OFTEN)
            assembly.contact("local", (f"{LOCAL}:back_off",), ints, pairs, apart=True)
        held = None if exact else lambda: _held(bodies)
        constrain = f"{EXACT}:constrain" if exact else f"{LOCAL}:constrain"
        assembly.term("constrain", constrain, ints, held, apart=not exact)
        assembly.remember(tally_at)

    def problems(self) -> Iterator[Problem]:
        """A restitution where there is none, and a gap that nothing has."""
        if self.mode == "barrier" and self.restitution.span is not None:
            yield Problem(NO_RESTITUTION, ("restitution",), at_key=True)
        if self.mode == "barrier" and self.rolling.span is not None:
            text = "mode barrier has no moment against rolling: modes exact and local have"
            yield Problem(text, ("rolling",), at_key=True)
        if self.mode in ("exact", "local") and self.gap is not None:
            yield Problem(f"mode {self.mode} has no gap: the mode barrier of elastic solids has", ("gap",), at_key=True)

    def keeps_apart(self, models: Mapping[str, Model]) -> bool:
        """Beside elastic solids."""
        return self.mode in ("auto", "barrier") and any(model.has_skin for model in models.values())

    def refusals(self, models: Mapping[str, Model]) -> Iterator[Diagnostic]:
        """Masses beside elastic solids; a moment against rolling that nothing would have; what skins in flows lack."""
        carried = [name for name, model in models.items() if model.carried]
        if carried:
            yield from self._refused_by_skins(carried[0], len(carried) == len(models))
            solid = next((name for name, model in models.items() if model.has_skin), None)
            if solid is not None:
                message = f"'{carried[0]}' is a skin in a flow, and does not collide with elastic solids as '{solid}'"
                written = next((ref.span for ref in self.between or () if ref.name == solid), None)
                yield Diagnostic("no-collider", message, written, "name under `between` what may touch, without it")
            models = {name: model for name, model in models.items() if not model.carried}
        soft = self.keeps_apart(models)
        whys = {name: "" if model.has_skin or model.turns else model.faceless() for name, model in models.items()}
        hard = next((name for name, why in whys.items() if why), None)
        if soft and hard is not None:
            from sceneql.contacts.barrier.refused import beside_solids

            written = next((ref.span for ref in self.between or () if ref.name == hard), None)
            yield beside_solids(hard, whys[hard], written)
        if soft and self.restitution.span is not None:
            yield Diagnostic("no-restitution", NO_RESTITUTION, self.restitution.span, NODES)
        if self.rolling.span is None or not models:
            return
        turning = any(model.turns for model in models.values())
        if turning and not soft:
            return
        if soft:
            why = "elastic solids roll by their own elasticity"
        else:
            why = f"'{next(iter(models))}' has masses, which do not turn"
        message = f"{why}: there is no moment against rolling"
        help = "rigid bodies have, in a collision of their own" if turning else "rigid bodies have"
        yield Diagnostic("no-rolling", message, self.rolling.span, help)

    def _refused_by_skins(self, name: str, alone: bool) -> Iterator[Diagnostic]:
        """Errors for settings that skins in a flow do not support; ``alone``: whether nothing else collides here."""
        if self.mode in ("exact", "local"):
            message = f"'{name}' is a skin in a flow, which has no mass of its own: it has no impacts"
            yield Diagnostic("no-collider", message, None, "leave the mode out")
        for what in ("restitution", "rolling") if alone else ():
            span = getattr(self, what).span
            if span is not None:
                message = f"'{name}' is a skin in a flow, which has no {what}: its tension throws off what touches it"
                yield Diagnostic("no-restitution", message, span, "leave it out")

    def assemble_skins(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> bool:
        """Add the barrier between all of these, unless the script asks for masses that collide."""
        if self.mode in ("exact", "local"):
            return False
        from sceneql.contacts.barrier.barrier_contact import assemble

        assembly.remember(*assemble(assembly, everyone, self._written(others), self.friction, self.gap))
        return True

    def _written(self, others: Sequence[Ref]) -> list[Ref]:
        """Objects, with their places in the script."""
        written = {ref.name: ref for ref in self.between or ()}
        return [written.get(ref.name, ref) for ref in others]

    def assemble_carried(
        self,
        name: str,
        assembly: Assembly,
        skins: Sequence[str],
        carried: Sequence[Bodies],
        everyone: Sequence[Bodies],
        others: tuple[Ref, ...],
    ) -> None:
        """Add the contacts of what a flow carries: of skins with one another, of these and masses with objects."""
        from sceneql.skins.touch.touching import assemble

        if carried and self.mode in ("exact", "local", "barrier"):
            text = f"masses of '{carried[0].model}' move as their flow does, and have no impacts in mode `{self.mode}`"
            raise ScriptError([Diagnostic("no-collider", text, assembly.line(), "leave the mode out")])
        for what in ("restitution", "rolling") if carried and not everyone else ():
            if getattr(self, what).span is not None:
                text = f"masses of '{carried[0].model}' move as their flow does, and have no {what}"
                raise ScriptError([Diagnostic("no-restitution", text, getattr(self, what).span, "leave it out")])
        touched = self._written(others)
        # A skin that could not be made has its own diagnostic.
        models: list[tuple[str, Any]] = [(skin, assembly.object(Ref(skin))) for skin in skins]
        made = [(skin, model.made) for skin, model in models if assembly.membrane_of(skin) is not None]
        if made or carried:
            told = assemble(assembly, made, carried, everyone, touched, self.friction, self.gap)
            assembly.remember(tallies.CARRIED, *told)

    def assemble_rigid(
        self, name: str, assembly: Assembly, everyone: Sequence[Bodies], others: tuple[Ref, ...]
    ) -> None:
        """Add the contacts of rigid bodies with one another, with objects and with masses, and of masses with objects.

        Raises ScriptError for a shape that is not covered, and for what mode `exact` does not take.
        """
        from sceneql.contacts.colliders import OFTEN
        from sceneql.contacts.distance.rigid_contact import assemble
        from sceneql.contacts.distance.rigid_masses import Masses, masses_of
        from sceneql.contacts.rigid_exact import group

        if self.mode == "barrier":
            message = "mode `barrier` is that of elastic solids, and rigid bodies are none"
            raise ScriptError([Diagnostic("no-collider", message, assembly.line(), "leave the mode out")])
        touched = self._written(others)
        rigid = [bodies for bodies in everyone if bodies.turning is not None]
        points = [bodies for bodies in everyone if bodies.turning is None]
        assembly.contact_why = "asked for by the script"
        if self.mode == "exact":
            masses = Masses(points, self.thickness, -1, -1) if points else None
            law = (self.restitution, self.friction, self.rolling)
            assembly.remember(*group.assemble(assembly, rigid, touched, *law, masses))
            return
        if self.mode == "auto" and self._exactly(name, assembly, rigid, points, touched):
            return
        if name in assembly.went_on:  # the tally up to that time
            tally_at = assembly.floats(tallies.tally(assembly.went_on[name]))
            assembly.remember(tally_at)
        assembly.step_at_most(OFTEN)
        masses = masses_of(points, self.thickness, assembly) if points else None
        told = assemble(assembly, rigid, touched, self.restitution, self.friction, self.rolling, masses)
        if masses is not None:
            assembly.remember(masses.tally_at, -1, *told, tallies.SPRINGS, masses.memory_at)
        else:
            assembly.remember(-1, *told)

    def _exactly(
        self, name: str, assembly: Assembly, rigid: list[Bodies], points: list[Bodies], touched: list[Ref]
    ) -> bool:
        """Add the contacts of few rigid bodies in mode `exact`, if it supports them; returns whether it does."""
        from sceneql.contacts.distance.rigid_masses import Masses
        from sceneql.contacts.rigid_exact import group

        count = sum(bodies.count for bodies in (*rigid, *points))
        why = ""
        if name in assembly.went_on:
            why = f"what is left of the run from {assembly.went_on[name].t:.6g} s on, where `exact` found no way"
        elif count > MOST_EXACT:
            why = f"more than {MOST_EXACT} bodies"
        elif not assembly.by_tolerance:
            why = "`exact` locates events in steps that a tolerance chooses, of an explicit method"
        else:
            try:
                masses = Masses(points, self.thickness, -1, -1) if points else None
                law = (self.restitution, self.friction, self.rolling)
                told = group.assemble(assembly, rigid, touched, *law, masses, gives_way=True)
            except ScriptError as refused:
                why = refused.diagnostics[0].message
            else:
                assembly.remember(*told)
        few = (
            f"chosen for up to {MOST_EXACT} rigid bodies; `local` goes on where it finds no way or takes too much work"
        )
        assembly.contact_why = f"chosen for rigid bodies: {why}" if why else few
        return not why


def _held(bodies: Bodies) -> Slopes:
    """Derivatives of local contacts within a stage."""
    import numpy as np

    from sceneql.system import Slopes

    tops = bodies.velocity_at + 3 * np.arange(bodies.count)
    return Slopes(
        "sceneql.contacts.stage_contacts_slopes_kernels:holds", rows=tops, columns=tops, blocks=True, in_stages=True
    )
