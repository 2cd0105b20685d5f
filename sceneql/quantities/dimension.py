"""Physical dimensions as exponents of the SI base units; a plane angle is plain (1), as in SI."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Dimension:
    """Exponents of (m, kg, s, A, K, mol, cd)."""

    exponents: tuple[Fraction, ...]

    def __mul__(self, other: Dimension) -> Dimension:
        return Dimension(tuple(a + b for a, b in zip(self.exponents, other.exponents, strict=True)))

    def __truediv__(self, other: Dimension) -> Dimension:
        return Dimension(tuple(a - b for a, b in zip(self.exponents, other.exponents, strict=True)))

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
