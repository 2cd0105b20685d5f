"""Path data of SVG as cubic curves (Scalable Vector Graphics 2, W3C 2018, chapter 9 and appendix B.2)."""

from __future__ import annotations

import cmath
import math
import re

Curve = tuple[complex, complex, complex, complex]
"""A cubic Bezier curve by its four control points x + i y, the first and the last of which are its ends."""

COUNTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
"""Number of arguments of each path command."""
NUMBER = re.compile(r"[\s,]*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")
FLAG = re.compile(r"[\s,]*([01])")
COMMAND = re.compile(r"[\s,]*([MLHVCSQTAZmlhvcsqtaz])")
BLANK = re.compile(r"\s*")
MOST_CURVES = 100_000
"""Most curves of a file; a file with more is refused before they fill the memory."""
LARGEST = 1e100
"""Largest coordinate, whose square is finite."""
FLATTEST = 1e-12
"""Least ratio of the radii of an arc; a flatter one is drawn as a line."""
ARC = math.pi / 8
"""Largest angle [rad] of an arc drawn by one cubic curve, whose relative error is then below 1e-7."""

STRAIGHT = 1e-9
"""Half the chord relative to the radius, below which an arc is a line to nine digits."""
VANISHING = 1e-100


def curves(data: str) -> list[list[Curve]]:
    """The paths of SVG path data, each a list of consecutive curves, closed by a line if open. Raises ValueError."""
    paths: list[list[Curve]] = []
    here = start = control = 0j
    before, count, at = "", 0, _after_blank(data, 0)
    while at < len(data):
        if count > MOST_CURVES:
            raise ValueError(f"path data has more than {MOST_CURVES} commands, or pieces of arcs")
        match = COMMAND.match(data, at)
        if match:
            letter, at = match[1], match.end()
        elif before in ("", "Z", "z"):
            raise ValueError(f"path data cannot have '{data[at : at + 12].strip()}' there")
        else:
            letter = {"M": "L", "m": "l"}.get(before, before)  # further numbers repeat the command
        if not before and letter not in "Mm":
            raise ValueError("path data begins with M")
        kind, relative = letter.upper(), letter.islower()
        numbers, at = _numbers(data, at, kind)
        origin = here if relative else 0j
        if kind in "HV":
            points = [_along(kind, numbers[0], here, relative)]
        else:
            tail = numbers[5:] if kind == "A" else numbers
            points = [origin + complex(x, y) for x, y in zip(tail[::2], tail[1::2], strict=True)]
        if kind == "M":
            start = points[0]
            paths.append([])
        elif kind == "Z":
            paths[-1].append(_line(here, start))
            points = [start]
            paths.append([])
        elif kind == "A":
            arc = _arc(here, numbers, points[0])
            paths[-1] += arc
            count += len(arc)
        else:
            curve = _curve(kind, here, points, control if before.upper() in _LIKE.get(kind, "") else here)
            paths[-1].append(curve)
            control = 2 * curve[3] - curve[2] if kind in "CS" else curve[3] + _LAST * (curve[3] - curve[2])
        here, before, at, count = points[-1], letter, _after_blank(data, at), count + 1
    return [[*path, _line(path[-1][3], path[0][0])] for path in paths if path]


_LIKE = {"S": "CS", "T": "QT"}
"""By smooth command, the preceding commands whose last control point is mirrored."""
_LAST = 1.5
"""Factor from a cubic's last control point, relative to its end, to that of the quadratic curve that it represents."""


def _after_blank(data: str, at: int) -> int:
    match = BLANK.match(data, at)
    return at if match is None else match.end()


def _numbers(data: str, at: int, kind: str) -> tuple[list[float], int]:
    found = []
    for k in range(COUNTS[kind]):
        match = (FLAG if kind == "A" and k in (3, 4) else NUMBER).match(data, at)
        if match is None:
            raise ValueError(f"'{kind}' of path data takes {COUNTS[kind]} numbers; there is '{data[at : at + 12]}'")
        found.append(float(match[1]))
        at = match.end()
    if not all(abs(number) <= LARGEST for number in found):
        raise ValueError(f"path data has a number beyond {LARGEST:g}")
    return found, at


def _along(kind: str, to: float, here: complex, relative: bool) -> complex:
    """End point of a horizontal (H) or vertical (V) line."""
    if kind == "H":
        return complex(here.real + to if relative else to, here.imag)
    return complex(here.real, here.imag + to if relative else to)


def _line(a: complex, b: complex) -> Curve:
    return a, a + (b - a) / 3, b + (a - b) / 3, b


def _curve(kind: str, here: complex, points: list[complex], mirrored: complex) -> Curve:
    """The cubic curve of a line, cubic or quadratic command; ``mirrored``: first control point of a smooth one."""
    if kind == "C":
        return here, points[0], points[1], points[2]
    if kind == "S":
        return here, mirrored, points[0], points[1]
    if kind in "QT":
        control, end = (points[0], points[1]) if kind == "Q" else (mirrored, points[0])
        return here, here + 2 / 3 * (control - here), end + 2 / 3 * (control - end), end
    return _line(here, points[0])


def _arc(a: complex, numbers: list[float], b: complex) -> list[Curve]:
    """Cubic curves along the elliptical arc from a to b, by its center (appendix B.2.4)."""
    rx, ry, turned, large, sweep = abs(numbers[0]), abs(numbers[1]), numbers[2], numbers[3], numbers[4]
    if a == b:
        return []
    if min(rx, ry) <= FLATTEST * max(rx, ry):
        return [_line(a, b)]
    turn = cmath.rect(1.0, math.radians(turned))
    far, least = max(rx, ry), FLATTEST * abs(b - a)
    if far < least:  # far too small radii would overflow below, where they are enlarged
        rx, ry = rx / far * least, ry / far * least

    def unit(z: complex) -> complex:
        """The vector in the frame in which the ellipse is the unit circle."""
        z /= turn
        return complex(z.real / rx, z.imag / ry)

    chord = unit(b - a)
    half = 0.5 * abs(chord)
    if half < (VANISHING if large else STRAIGHT):
        return [_line(a, b)]
    grown = max(1.0, half)  # too small radii are enlarged until the ends fit
    way = math.sqrt(max(0.0, grown * grown - half * half)) * (1 if large != sweep else -1)
    center = 0.5 * chord + 1j * way * chord / abs(chord)  # from a
    first = cmath.phase(-center)
    sweep_angle = cmath.phase((chord - center) / -center)
    if large and abs(sweep_angle) < STRAIGHT:  # the ends coincide by rounding: almost the whole ellipse
        sweep_angle = math.tau if sweep else -math.tau
    elif sweep and sweep_angle < 0:
        sweep_angle += math.tau
    elif not sweep and sweep_angle > 0:
        sweep_angle -= math.tau

    def place(z: complex) -> complex:
        return a + turn * complex(rx * (z.real + center.real), ry * (z.imag + center.imag))

    count = max(1, math.ceil(abs(sweep_angle) / ARC))
    step = sweep_angle / count
    reach = 4 / 3 * math.tan(step / 4) * 1j
    row = []
    for k in range(count):
        p, q = cmath.rect(grown, first + k * step), cmath.rect(grown, first + (k + 1) * step)
        row.append((place(p), place(p + reach * p), place(q - reach * q), place(q)))
    return [*row[:-1], (*row[-1][:3], b)]
