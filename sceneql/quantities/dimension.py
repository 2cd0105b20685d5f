"""Physical dimensions as exponents of the SI base units; a plane angle is plain (1), as in SI, and says what it is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Dimension:
    """Exponents of (m, kg, s, A, K, mol, cd)."""

    exponents: tuple[Fraction, ...]
    kind: str = field(default="", compare=False)
    """The kind of a plain number in words: `an angle`, `a percentage`, or the former dimension of a define whose unit a
    formula in plain numbers drops; else empty. Sums and choices keep it; products, quotients, powers and functions drop
    it."""

    def __mul__(self, other: Dimension) -> Dimension:
        pairs = zip(self.exponents, other.exponents, strict=True)
        return Dimension(tuple(a + b if a and b else a or b for a, b in pairs))  # a sum of fractions takes long

    def __truediv__(self, other: Dimension) -> Dimension:
        return Dimension(tuple(a - b if b else a for a, b in zip(self.exponents, other.exponents, strict=True)))

    def __pow__(self, power: Fraction | int) -> Dimension:
        return Dimension(tuple(a * power for a in self.exponents))

    @property
    def plain(self) -> bool:
        """Whether this is the dimension of a plain number."""
        return not any(self.exponents)

    def __str__(self) -> str:
        """The unit in SI base units, such as ``kg*m/s^2``; ``1`` for a plain number."""
        up = [_factor(s, e) for s, e in zip(_SYMBOLS, self.exponents, strict=True) if e > 0]
        down = [_factor(s, -e) for s, e in zip(_SYMBOLS, self.exponents, strict=True) if e < 0]
        text = "*".join(up) or "1"
        return text + "".join("/" + d for d in down)


_SYMBOLS = ("m", "kg", "s", "A", "K", "mol", "cd")


def _factor(symbol: str, exponent: Fraction) -> str:
    if exponent == 1:
        return symbol
    return f"{symbol}^{exponent}" if exponent.denominator == 1 else f"{symbol}^({exponent})"


def _base(index: int) -> Dimension:
    return Dimension(tuple(Fraction(int(k == index)) for k in range(7)))


PLAIN = _base(-1)
ANGLE, PERCENTAGE = replace(PLAIN, kind="an angle"), replace(PLAIN, kind="a percentage")
LENGTH, MASS, TIME, CURRENT, TEMPERATURE, AMOUNT, LUMINOUS_INTENSITY = (_base(k) for k in range(7))
AREA, VOLUME = LENGTH**2, LENGTH**3
VELOCITY = LENGTH / TIME
ACCELERATION = VELOCITY / TIME
FREQUENCY = PLAIN / TIME
FORCE = MASS * ACCELERATION
ENERGY = FORCE * LENGTH
POWER = ENERGY / TIME
PRESSURE = FORCE / AREA
STIFFNESS = FORCE / LENGTH
DAMPING = FORCE / VELOCITY
DENSITY = MASS / VOLUME
MOMENTUM = MASS * VELOCITY


def common(dimensions: Iterable[Dimension | None]) -> Dimension | None:
    """The dimension of a sum or list of quantities, which all have one dimension (None: any, as the literal 0).

    An angle and a plain number give an angle, a percentage and a plain number a percentage; another kind is kept if all
    agree on it.
    """
    known = [dimension for dimension in dimensions if dimension is not None]
    if not known:
        return None
    if len({dimension.kind for dimension in known}) == 1:
        return known[0]
    lasting = (ANGLE.kind, PERCENTAGE.kind)
    return next((one for one in known if one.kind in lasting), replace(known[0], kind=""))


def suits(given: Dimension | None, wanted: Dimension | None) -> bool:
    """Whether a quantity may stand where one of another dimension is wanted; None goes with any.

    A plain number stands for SI anywhere, but an angle for angles alone, and a percentage for plain numbers alone.
    """
    if given is None or wanted is None:
        return True
    if not given.plain:
        return given == wanted
    return not given.kind or (wanted.plain and given.kind == (wanted.kind or PERCENTAGE.kind))


def comparable(given: Dimension | None, measured: Dimension | None) -> bool:
    """Whether a quantity may be compared with a measured one.

    Any two plain numbers may, as angles are not marked as such.
    """
    both_plain = given is not None and measured is not None and given.plain and measured.plain
    return both_plain or suits(given, measured)
