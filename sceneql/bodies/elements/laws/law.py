"""Base class of elastic laws: fields of a script, and the material's parameters at points."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import create_model

from sceneql.bodies.elements.named import named
from sceneql.kinds import Formula, Problem, Record, Symbols, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Symbol, walk

if TYPE_CHECKING:
    from sceneql.frame import Floats

AXES = ("x", "y", "z")
POISSON = 0.3
"""Default Poisson's ratio."""
MATERIAL = "at the place x, y, z [m] of the material before it moves"
Modulus = Annotated[Formula, Symbols(AXES, dim.PRESSURE, at_start=True)]
Ratio = Annotated[Formula, Symbols(AXES, dim.PLAIN, at_start=True)]


class Law(Record):
    """An elastic law of two numbers: the energy of strain is shape(F) + bulk d(F)^2 / 2.

    F is the deformation gradient and d a measure of dilatation, 0 without strain. So `bulk` may act on the mean of d.
    """

    kernels: ClassVar[str]
    """The module of its kernels (law_kernels.py)."""
    recovers: ClassVar[bool] = True
    """Whether inverted elements are pushed back."""
    turns: ClassVar[bool] = True
    """Whether a rotation makes no stress."""

    modulus: Modulus = field(f"Young's modulus, {MATERIAL}.")
    poisson: Ratio | None = field(
        f"Poisson's ratio, above -1 and below 0.5, likewise; by default {POISSON}.",
        None,
    )

    def problems(self) -> Iterator[Problem]:
        """Problems: constant parameters out of their range."""
        for name in type(self).model_fields:
            formula = getattr(self, name)
            if isinstance(formula, Formula) and not _varies(formula):
                wrong = self.wrong(name, float(evaluate(formula.expr, {})))
                if wrong:
                    yield Problem(wrong, (name,), code="out-of-range")

    @classmethod
    def wrong(cls, name: str, number: float) -> str:
        """The message on a value out of a field's range; empty for a value in it."""
        if name != "poisson":
            return "" if 0.0 < number < float("inf") else f"{name} must be above 0 Pa, not {number:g} Pa"
        if number == 0.5:
            more = "write `poisson: 0.4999`, and beside `law` `element: p2_mean`"
            return f"a Poisson ratio of 0.5 leaves no volume to change; {more}"
        return "" if -1.0 < number < 0.5 else f"poisson must be above -1 and below 0.5, not {number:g}"

    def at(self, name: str, places: Floats) -> Floats:
        """Values (n,) of a field at material positions (n, 3) [m]. Raises ScriptError where one is out of range."""
        import numpy as np

        formula = getattr(self, name)
        if formula is None:
            return np.full(len(places), POISSON)
        known = {Symbol(axis): places[:, k] for k, axis in enumerate(AXES)}
        values = np.broadcast_to(np.asarray(evaluate(formula.expr, known, arrays=True), dtype=float), len(places))
        for k in (int(np.argmin(values)), int(np.argmax(values))):
            if wrong := self.wrong(name, float(values[k])):
                where = ", ".join(f"{c:.4g}" for c in places[k])
                raise ScriptError([Diagnostic("out-of-range", f"at ({where}) m {wrong}", formula.span)])
        return values.copy()

    def most_poisson(self) -> float:
        """Poisson's ratio if it is constant; 0.5, its upper bound, if it varies."""
        if self.poisson is None:
            return POISSON
        return 0.5 if _varies(self.poisson) else float(evaluate(self.poisson.expr, {}))

    def wave_modulus(self) -> float | None:
        """Stress over strain [Pa] of pressure waves; None where it varies."""
        modulus = number(self.modulus)
        poisson = POISSON if self.poisson is None else number(self.poisson)
        if modulus is None or poisson is None:
            return None
        return modulus * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson))

    def varies(self, name: str) -> bool:
        """Whether a field depends on the position."""
        formula = getattr(self, name)
        return formula is not None and _varies(formula)

    def warning(self) -> str:
        """Limitations of the law, for `explain`; empty without any."""
        lost = [] if self.turns else ["rotation makes a false stress"]
        lost += [] if self.recovers else ["what is turned inside out does not come back"]
        return f"; by this law {', and '.join(lost)}" if lost else ""

    def moduli(self, places: Floats) -> tuple[Floats, Floats]:
        """Lame's first parameter (n,) and the shear modulus (n,) [Pa] at material positions (n, 3) [m]."""
        modulus, poisson = self.at("modulus", places), self.at("poisson", places)
        shear = modulus / (2.0 * (1.0 + poisson))
        return 2.0 * shear * poisson / (1.0 - 2.0 * poisson), shear

    def numbers(self, places: Floats) -> Floats:
        """Parameters (n, k) of the law's kernels at material positions (n, 3) [m]: `bulk` [Pa], then the law's own."""
        import numpy as np

        return np.column_stack(self.moduli(places))


def number(formula: Formula) -> float | None:
    """The value of a formula that is the same everywhere; None for another."""
    return None if _varies(formula) else float(evaluate(formula.expr, {}))


def _varies(formula: Formula) -> bool:
    return any(isinstance(node, Symbol) for node in walk(formula.expr))


class OneLaw(Record):
    """A law by its name."""

    def problems(self) -> Iterator[Problem]:
        """A problem where more or less than one law is given."""
        given = [name for name in type(self).model_fields if getattr(self, name) is not None]
        if len(given) != 1:
            known = ", ".join(type(self).model_fields)
            said = f", not {' and '.join(given)}" if given else ""
            yield Problem(f"a solid has one law of {known}{said}", tuple(given[1:2]), at_key=True)

    @property
    def law(self) -> Law:
        """The given law."""
        found: Law = next(value for name in type(self).model_fields if (value := getattr(self, name)) is not None)
        return found


def _laws() -> dict[str, Any]:
    found = named("sceneql.bodies.elements.laws", "Law")
    return {name: (cls | None, field(str(cls.__doc__).partition("\n")[0], None)) for name, cls in found.items()}


if TYPE_CHECKING:
    Laws = OneLaw
else:
    Laws = create_model("Laws", __base__=OneLaw, __doc__=OneLaw.__doc__, **_laws())
