"""First entries of rays into solids by exact rational arithmetic: what certified roots are held to.

A float64 is a rational number, and so a tape of polynomials along a ray of float64s is a polynomial with rational
coefficients. Its real roots are isolated by FLINT (Johansson, arb_fmpz_poly), and whether the solid lies between two
of them is asked at a rational place between: nothing here rounds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise

from flint import arb, ctx, fmpq, fmpq_poly

from sceneql.field.tape import tape_ops as ops
from sceneql.frame import Tape

BITS = 256
"""Of the roots' isolating intervals."""


def exact(number: float) -> fmpq:
    """A float64 as what it is."""
    return fmpq(*float(number).as_integer_ratio())


def along(tape: Tape, origin: Sequence[float], direction: Sequence[float]) -> fmpq_poly:
    """The polynomial that a tape is along a ray, exactly. ValueError where it is none."""
    registers: list[fmpq_poly] = []
    place = [fmpq_poly([exact(o), exact(d)]) for o, d in zip(origin, direction, strict=True)]
    for op, left, right, _ in tape.code.tolist():
        if op == ops.CONSTANT:
            made = fmpq_poly([exact(tape.constants[left])])
        elif op in (ops.X, ops.Y, ops.Z):
            made = place[op - ops.X]
        elif op in (ops.ADD, ops.SUB, ops.MUL):
            a, b = registers[left], registers[right]
            made = a + b if op == ops.ADD else a - b if op == ops.SUB else a * b
        elif op == ops.SQUARE:
            made = registers[left] * registers[left]
        elif op in (ops.NEG, ops.COPY):
            made = -registers[left] if op == ops.NEG else registers[left]
        else:
            raise ValueError(f"operation {op} is no polynomial")
        registers.append(made)
    return registers[-1]


def real_roots(polynomial: fmpq_poly) -> list[tuple[arb, int]]:
    """Real roots in order, each enclosed and apart from the others, with its multiplicity."""
    ctx.prec = BITS
    if polynomial.degree() < 1:
        return []
    found = [(root.real, many) for root, many in polynomial.numer().complex_roots() if root.imag == 0]
    return sorted(found, key=lambda pair: float(pair[0].mid()))


def rational(place: arb) -> fmpq:
    """The middle of an enclosure."""
    mantissa, exponent = place.mid().man_exp()
    two = fmpq(2)
    return fmpq(int(mantissa)) * two ** int(exponent)


def first_entry(
    inside: Callable[[fmpq], bool], places: Sequence[arb], t0: float, t1: float
) -> tuple[str, float | None]:
    """("inside" | "hit" | "miss", t) of the first entry in [t0, t1]; ``inside`` can change at the ``places`` alone."""
    low, high = exact(t0), exact(t1)
    within = [(rational(place), place) for place in places]
    within = sorted((middle, place) for middle, place in within if low < middle < high)
    edges = [low, *(middle for middle, _ in within), high]
    for k in range(len(edges) - 1):
        if inside((edges[k] + edges[k + 1]) / 2):
            return ("inside", t0) if k == 0 else ("hit", float(Fraction(int(edges[k].p), int(edges[k].q))))
    return "miss", None


def roots_of(*polynomials: fmpq_poly) -> list[arb]:
    """Where any of some polynomials has a real root."""
    return [place for polynomial in polynomials for place, _ in real_roots(polynomial)]


def blob_entry(
    parts: Sequence[Sequence[float]], threshold: float, ray: Sequence[Sequence[float]], t0: float, t1: float
) -> tuple[str, float | None]:
    """First entry into {threshold < sum of (1 - d^2/R^2)^3 where d < R}; parts are (x, y, z, R).

    Along a ray the density is a polynomial of degree six between the places where the ray meets a part's ball.
    """
    one, level = fmpq_poly([1]), fmpq_poly([exact(threshold)])
    shares = []
    for *center, radius in parts:
        lines = [fmpq_poly([exact(o) - exact(c), exact(d)]) for o, d, c in zip(*ray, center, strict=True)]
        squared = sum((line * line for line in lines), fmpq_poly([0]))
        share = one - squared / (exact(radius) * exact(radius))
        if share[1] * share[1] > 4 * share[0] * share[2]:
            shares.append(share)
    edges = sorted([exact(t0), exact(t1), *map(rational, roots_of(*shares))])
    places = roots_of(*shares)
    for a, b in pairwise(edges):
        middle = (a + b) / 2
        near = [share * share * share for share in shares if share(middle) > 0]
        places += [place for place in roots_of(sum(near, fmpq_poly([0])) - level) if a < rational(place) < b]

    def inside(t: fmpq) -> bool:
        return bool(sum((max(share(t), fmpq(0)) ** 3 for share in shares), fmpq(0)) > level(t))

    return first_entry(inside, places, t0, t1)
