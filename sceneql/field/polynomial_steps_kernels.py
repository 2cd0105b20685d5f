# mypy: ignore-errors
"""Steps towards the first roots of polynomials on pieces of rays, in lanes: quadratic enclosures and Newton's method.

``lanes`` is one array, what is told of all lanes one behind the other; places are tau of [-1, 1] on the ray's piece.
On a segment a polynomial is enclosed by a parabola +- e in sigma of [-1, 1], of which the higher powers take their
share. A segment without a root of the lower bound is rejected, the next one is twice as long; else it begins anew at
the first root of the lower bound.
"""

import numpy as np

from sceneql.field.moved_kernels import moved_4, moved_6, moved_8
from sceneql.field.packet_kernels import LANES
from sceneql.field.powers_kernels import enclosed_4, enclosed_6, enclosed_8
from sceneql.field.single_kernels import lane
from sceneql.field.tape_ops import HIT, MISS, UNDECIDED
from sceneql.kernels import inlined

ROOT, CHANGE, A, B, END, TRIES, STATE, MIDDLE, HALF_WAY, RAY, C = range(0, 11 * LANES, LANES)
"""Root and its change at the last step of the polish, segment, where the search ends, steps so far, outcome (LIVE until
there is one), middle and half length of the piece, which ray it is of, then coefficients from the lowest on."""
C1, C2, C3, C4, C5, C6, C7, C8, ROWS = range(C + LANES, C + 10 * LANES, LANES)
LIVE = -1.0
MOST = 48.0
"""Steps after which a ray is left to the certified routine."""
LEAST = 1.0e-8
"""Width of a segment that is left to it."""
BLUR, LESS = 4.0e-16, 1.0 - 1.0e-14
SHORTER = 0.25
"""Part of a segment that is looked at next where its begin is not enough nearer to a root."""
BEFORE = 1.0e-5
"""How far before the end of a segment, relative to half of it, a place inside is looked for."""
TURNS, MOST_TURNS = 3, 9
"""Newton's steps, and as many where they have not settled."""
UNSETTLED = 2.0e-7
"""Change of a root at the last step, on a piece of length 2, that asks for another one."""


@lane
def advance(lanes, i, q0, q1, q2, e, steep, off, anywhere):
    """Reject or cut the segment of a lane, p in q0 + q1 sigma + q2 sigma^2 +- e there, or tell its outcome."""
    a, b, end, tries = lanes[A + i], lanes[B + i], lanes[END + i], lanes[TRIES + i]
    width = b - a
    e += off
    low, high = q0 - e, q0 + e
    flat = abs(q1)
    # The parabola's least value stands at an end, or between them at low - q1^2/(4 q2).
    dips = (q2 + q2 > flat) & (4.0 * q2 * low * LESS <= q1 * q1)
    clear = (low + q2 - flat > 0.0) & (~dips)
    left = low - q1 + q2
    slope = q1 - 2.0 * q2
    part = 4.0 * q2 * left
    square = slope * slope - part
    square += 1.0e-14 * (slope * slope + abs(part))
    down = np.sqrt(square if square > 0.0 else 0.0) - slope
    ahead = (left > 0.0) & (down > 0.0)
    start = a + width * (left / (down if ahead else 1.0)) * LESS - BLUR
    start = start if ahead & (start > a) else a
    start = start if start < b else b
    # A place inside stands before the segment's end: on the end of a ray another field may vanish.
    late = BEFORE if anywhere else 0.0
    sigma = 1.0 - late
    inside = high + sigma * (q1 + sigma * q2) < 0.0
    begun = high - q1 + q2 < 0.0
    hit = begun | (inside & (anywhere | (steep + off < 0.0)))
    narrow = b - start
    cut = start + SHORTER * narrow if inside | (narrow > 0.5 * width) else b
    on = b + 2.0 * width
    on = on if on < end else end
    stuck = (narrow <= LEAST) | (tries > MOST)
    outcome = HIT if hit else (UNDECIDED if stuck else LIVE)
    outcome = (MISS if b >= end else LIVE) if clear else outcome
    live = lanes[STATE + i] == LIVE
    start = a if begun else start
    stop = (a if begun else b - 0.5 * late * width) if hit else cut
    lanes[STATE + i] = float(outcome) if live else lanes[STATE + i]
    lanes[A + i] = (b if clear else start) if live else a
    lanes[B + i] = (on if clear else stop) if live else b
    lanes[END + i] = b if live & inside & (~clear) else end
    lanes[TRIES + i] = tries + 1.0


@inlined
def step_4(lanes, n, off, anywhere):
    """A step of n lanes, degrees up to 4."""
    for i in range(n):
        m, h = 0.5 * (lanes[A + i] + lanes[B + i]), 0.5 * (lanes[B + i] - lanes[A + i]) + BLUR
        c0, c1, c2, c3, c4 = moved_4(lanes[C + i], lanes[C1 + i], lanes[C2 + i], lanes[C3 + i], lanes[C4 + i], m)
        h2 = h * h
        q0, q1, q2, e, steep = enclosed_4(c0, h * c1, h2 * c2, h * h2 * c3, h2 * h2 * c4)
        advance(lanes, i, q0, q1, q2, e, steep, off, anywhere)


@inlined
def step_6(lanes, n, off, anywhere):
    """Up to 6."""
    for i in range(n):
        m, h = 0.5 * (lanes[A + i] + lanes[B + i]), 0.5 * (lanes[B + i] - lanes[A + i]) + BLUR
        c0, c1, c2, c3, c4, c5, c6 = moved_6(
            lanes[C + i], lanes[C1 + i], lanes[C2 + i], lanes[C3 + i], lanes[C4 + i], lanes[C5 + i], lanes[C6 + i], m
        )  # fmt: skip
        h2 = h * h
        h3, h4 = h * h2, h2 * h2
        q0, q1, q2, e, steep = enclosed_6(c0, h * c1, h2 * c2, h3 * c3, h4 * c4, h2 * h3 * c5, h3 * h3 * c6)
        advance(lanes, i, q0, q1, q2, e, steep, off, anywhere)


@inlined
def step_8(lanes, n, off, anywhere):
    """Up to 8."""
    for i in range(n):
        m, h = 0.5 * (lanes[A + i] + lanes[B + i]), 0.5 * (lanes[B + i] - lanes[A + i]) + BLUR
        c0, c1, c2, c3, c4, c5, c6, c7, c8 = moved_8(
            lanes[C + i], lanes[C1 + i], lanes[C2 + i], lanes[C3 + i], lanes[C4 + i], lanes[C5 + i], lanes[C6 + i],
            lanes[C7 + i], lanes[C8 + i], m,
        )  # fmt: skip
        h2 = h * h
        h3, h4 = h * h2, h2 * h2
        q0, q1, q2, e, steep = enclosed_8(
            c0, h * c1, h2 * c2, h3 * c3, h4 * c4, h2 * h3 * c5, h3 * h3 * c6, h3 * h4 * c7, h4 * h4 * c8
        )
        advance(lanes, i, q0, q1, q2, e, steep, off, anywhere)


@inlined
def step(lanes, degree, n, off, anywhere):
    """A step of n lanes."""
    if degree <= 4:
        step_4(lanes, n, off, anywhere)
    elif degree <= 6:
        step_6(lanes, n, off, anywhere)
    else:
        step_8(lanes, n, off, anywhere)


@lane
def down(c, p, s, x):
    """A step of Horner's scheme for p and its derivative s."""
    return c + x * p, p + x * s


@lane
def newton_4(lanes, i, p, s, x):
    """p and its derivative at x, of which those of the coefficients from C4 on are given."""
    p, s = down(lanes[C3 + i], p, s, x)
    p, s = down(lanes[C2 + i], p, s, x)
    p, s = down(lanes[C1 + i], p, s, x)
    return down(lanes[C + i], p, s, x)


@lane
def newton_6(lanes, i, p, s, x):
    """From C6 on."""
    p, s = down(lanes[C5 + i], p, s, x)
    p, s = down(lanes[C4 + i], p, s, x)
    return newton_4(lanes, i, p, s, x)


@lane
def newton(lanes, i, p, s, x):
    """Newton's step from x, held in A..B."""
    root = x - p / s
    root = root if root > lanes[A + i] else lanes[A + i]
    root = root if root < lanes[B + i] else lanes[B + i]
    lanes[CHANGE + i] = abs(root - x)
    lanes[ROOT + i] = root


@inlined
def settled(lanes, n):
    """Whether the roots of all lanes that hit changed little at the last step."""
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
