# mypy: ignore-errors
"""Steps towards the first roots of polynomials on pieces of rays, in lanes: Bernstein's basis and Newton's method.

``lanes`` is one array with ABREAST numbers of each kind; places are tau of [-1, 1] on the ray's piece. A segment whose
coefficients are all positive is rejected, and the rest of the search becomes the next one; else its begin moves to the
zero of the line from the first coefficient along the steepest descent to another: no coefficient is below that line,
and so neither is the polynomial (first steps of the clipping of Sederberg & Nishita 1990, at one end).
"""

from sceneql.compiled.kernels import inlined
from sceneql.field.roots.hull_kernels import hull_4, hull_6, hull_8
from sceneql.field.roots.polynomial_kernels import ABREAST
from sceneql.field.tape.single_kernels import lane
from sceneql.field.tape.tape_ops import HIT, MISS, UNDECIDED

ROOT, CHANGE, A, B, END, STATE, MIDDLE, HALF_WAY, RAY, C = range(0, 10 * ABREAST, ABREAST)
"""Offsets in ``lanes``: root and its change at the last step of the polish, segment, end of the search, outcome (LIVE
until there is one), middle and half length of the ray's piece, index of the ray, coefficients from the lowest on."""
C1, C2, C3, C4, C5, C6, C7, C8, ROWS = range(C + ABREAST, C + 10 * ABREAST, ABREAST)
LIVE = -1.0
MOST = 48
"""Steps after which a ray is left to the certified routine."""
LEAST = 1.0e-8
"""Width of a segment that is left to the certified routine."""
BLUR, LESS = 4.0e-16, 1.0 - 1.0e-14
GAIN, SHORTER = 0.7, 0.3
"""A cut that leaves more than GAIN of a segment is followed by a look at SHORTER of the rest."""
LATE = 5.0e-6
"""Margin before the end of a segment, relative to it, at which the inside is tested."""
TURNS, MOST_TURNS = 3, 9
"""Newton steps, and their number when they have not converged."""
UNSETTLED = 2.0e-8
"""Change of a root at the last step, on a piece of length 2, above which Newton's method goes on."""


@lane
def advance(lanes, i, first, last, lowest, highest, steepest, rise, off, before, late, last_try):
    """Reject or cut a lane's segment, or set its outcome, by ``hull_4`` of p - off there; returns 1 if still live.

    ``late`` is the margin before the segment's end at which the inside is tested, ``before`` the degree times it.
    """
    a, b, end = lanes[A + i], lanes[B + i], lanes[END + i]
    width = b - a
    clear = lowest > 0.0
    # No coefficient lies below the line of the steepest descent.
    ahead = (first > 0.0) & (steepest > 0.0)
    start = a + width * (first / (steepest if ahead else 1.0)) * LESS - BLUR
    start = start if ahead & (start > a) else a
    start = start if start < b else b
    begun = first + 2.0 * off < 0.0
    # The inside is tested before the segment's end: at the end of a ray a clip may vanish.
    inside = last + before * (highest - last) + 2.0 * off < 0.0
    hit = begun | (inside & ((late > 0.0) | (rise + off < 0.0)))
    narrow = b - start
    cut = start + SHORTER * narrow if inside | (narrow > GAIN * width) else b
    stuck = (narrow <= LEAST) | last_try
    outcome = HIT if hit else (UNDECIDED if stuck else LIVE)
    outcome = (MISS if b >= end else LIVE) if clear else outcome
    live = lanes[STATE + i] == LIVE
    start = a if begun else start
    stop = (a if begun else b - late * width) if hit else cut
    lanes[STATE + i] = float(outcome) if live else lanes[STATE + i]
    lanes[A + i] = (b if clear else start) if live else a
    lanes[B + i] = (end if clear else stop) if live else b
    lanes[END + i] = b if live & inside & (~clear) else end
    return 1 if live & (outcome == LIVE) else 0


@inlined
def step_4(lanes, n, off, late, last_try):
    """A step of n lanes, degrees up to 4; returns how many stay live."""
    count = 0
    for i in range(n):
        m, h = 0.5 * (lanes[A + i] + lanes[B + i]), 0.5 * (lanes[B + i] - lanes[A + i]) + BLUR
        first, last, lowest, highest, steepest, rise = hull_4(
            lanes[C + i], lanes[C1 + i], lanes[C2 + i], lanes[C3 + i], lanes[C4 + i], m, h, off
        )  # fmt: skip
        count += advance(lanes, i, first, last, lowest, highest, steepest, rise, off, 4.0 * late, late, last_try)
    return count


@inlined
def step_6(lanes, n, off, late, last_try):
    """As ``step_4``, degrees up to 6."""
    count = 0
    for i in range(n):
        m, h = 0.5 * (lanes[A + i] + lanes[B + i]), 0.5 * (lanes[B + i] - lanes[A + i]) + BLUR
        first, last, lowest, highest, steepest, rise = hull_6(
            lanes[C + i], lanes[C1 + i], lanes[C2 + i], lanes[C3 + i], lanes[C4 + i], lanes[C5 + i], lanes[C6 + i],
            m, h, off,
        )  # fmt: skip
        count += advance(lanes, i, first, last, lowest, highest, steepest, rise, off, 6.0 * late, late, last_try)
    return count


@inlined
def step_8(lanes, n, off, late, last_try):
    """As ``step_4``, degrees up to 8."""
    count = 0
    for i in range(n):
        m, h = 0.5 * (lanes[A + i] + lanes[B + i]), 0.5 * (lanes[B + i] - lanes[A + i]) + BLUR
        first, last, lowest, highest, steepest, rise = hull_8(
            lanes[C + i], lanes[C1 + i], lanes[C2 + i], lanes[C3 + i], lanes[C4 + i], lanes[C5 + i], lanes[C6 + i],
            lanes[C7 + i], lanes[C8 + i], m, h, off,
        )  # fmt: skip
        count += advance(lanes, i, first, last, lowest, highest, steepest, rise, off, 8.0 * late, late, last_try)
    return count


@inlined
def step(lanes, degree, n, off, anywhere, last_try):
    """A step of n lanes; returns how many stay live."""
    late = LATE if anywhere else 0.0
    if degree <= 4:
        return step_4(lanes, n, off, late, last_try)
    if degree <= 6:
        return step_6(lanes, n, off, late, last_try)
    return step_8(lanes, n, off, late, last_try)


@lane
def down(c, p, s, x):
    """A step of Horner's scheme for p and its derivative s."""
    return c + x * p, p + x * s


@lane
def newton_4(lanes, i, p, s, x):
    """p and its derivative at x by Horner's scheme; the arguments are theirs from the coefficients C4 and up."""
    p, s = down(lanes[C3 + i], p, s, x)
    p, s = down(lanes[C2 + i], p, s, x)
    p, s = down(lanes[C1 + i], p, s, x)
    return down(lanes[C + i], p, s, x)


@lane
def newton_6(lanes, i, p, s, x):
    """As ``newton_4``, from C6 on."""
    p, s = down(lanes[C5 + i], p, s, x)
    p, s = down(lanes[C4 + i], p, s, x)
    return newton_4(lanes, i, p, s, x)


@lane
def newton(lanes, i, p, s, x):
    """Newton's step from x, clamped to A..B."""
    root = x - p / s
    root = root if root > lanes[A + i] else lanes[A + i]
    root = root if root < lanes[B + i] else lanes[B + i]
    lanes[CHANGE + i] = abs(root - x)
    lanes[ROOT + i] = root


@inlined
def settled(lanes, n):
    """Whether the roots of all lanes that hit have converged at the last step."""
    moving = 0
    for i in range(n):
        moving += 1 if (lanes[CHANGE + i] > UNSETTLED) & (lanes[STATE + i] == HIT) else 0
    return moving == 0


@inlined
def polish(lanes, degree, n):
    """Roots in A..B of n lanes, where p falls: Newton's method from A on."""
    for i in range(n):
        lanes[ROOT + i] = lanes[A + i]
    for turn in range(MOST_TURNS):
        if turn >= TURNS and settled(lanes, n):
            break
        if degree <= 4:
            for i in range(n):
                x = lanes[ROOT + i]
                p, s = newton_4(lanes, i, lanes[C4 + i], 0.0, x)
                newton(lanes, i, p, s, x)
        elif degree <= 6:
            for i in range(n):
                x = lanes[ROOT + i]
                p, s = newton_6(lanes, i, lanes[C6 + i], 0.0, x)
                newton(lanes, i, p, s, x)
        else:
            for i in range(n):
                x = lanes[ROOT + i]
                p, s = down(lanes[C7 + i], lanes[C8 + i], 0.0, x)
                p, s = down(lanes[C6 + i], p, s, x)
                p, s = newton_6(lanes, i, p, s, x)
                newton(lanes, i, p, s, x)
