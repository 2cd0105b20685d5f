"""Closed paths of an SVG file as polygons. Standard library only, since the command `check` uses it.

Elements: path, polygon, rect, circle, ellipse, in groups, with transforms (Scalable Vector Graphics 2, W3C 2018,
chapters 8 to 10). All shapes become cubic Bezier curves of complex points x + i y, finally approximated by chords.
"""

from __future__ import annotations

import cmath
import math
import re
from collections import Counter
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

from sceneql.grids.domain.svg_path import LARGEST, MOST_CURVES, Curve, curves

LARGEST_FILE = 4 * 2**20
MOST_CORNERS = 20_000
MOST_TRANSFORMS = 1_000
"""Most steps of one transform."""
CHORD = 5e-5
"""Largest distance of a chord from its curve, relative to the picture's size."""
RESOLVED = 1e-9
"""Least size of a picture relative to its distance from the origin; below it rounding distorts the shape."""
DEEPEST = 100
"""Deepest nesting of groups."""
SHOWN = 40
"""Characters of a file that a message quotes."""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
TRANSFORM = re.compile(r"\s*+,?\s*+(\w++)\s*+\(([^()]*+)\)\s*+")
UNDRAWN = {"defs", "symbol", "clipPath", "mask", "pattern", "marker"}

Corners = tuple[tuple[float, float], ...]
Matrix = tuple[complex, complex, complex]
"""An affine map z -> m[0] Re z + m[1] Im z + m[2] of complex points."""


def rings(file: str) -> dict[str, Corners]:
    """Polygons by the id of their element, the largest first, in the file's units with y up.

    Raises ValueError for a file that is too large or no SVG, and where it has no closed path.
    """
    try:
        seen = Path(file).stat()
        return _rings(file, (seen.st_mtime_ns, seen.st_size, seen.st_ino))
    except OSError as error:
        raise ValueError(f"{Path(file).name} cannot be read: {error.strerror}") from None


@lru_cache(maxsize=16)
def _rings(file: str, version: tuple[int, int, int]) -> dict[str, Corners]:
    """As `rings`, cached by the file's version (time, size, inode). Raises OSError, and ValueError as `rings`."""
    path = Path(file)
    if version[1] > LARGEST_FILE:
        raise ValueError(f"{path.name} is larger than the {LARGEST_FILE} bytes that an SVG may have")
    text = path.read_bytes()
    declared = text.replace(b"\0", b"")  # UTF-16 has zeros between the letters
    if b"<!ENTITY" in declared or b"<!ATTLIST" in declared:  # entities may expand a few bytes to any number
        raise ValueError(f"{path.name} defines entities, which are not read")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, LookupError, ValueError) as error:  # bad encodings raise LookupError or ValueError
        raise ValueError(f"{path.name} is no SVG: {_cut(str(error), 2 * SHOWN)}") from None
    try:
        drawn = _drawn(root)
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from None
    if not drawn:
        raise ValueError(f"{path.name} has no path, polygon, rect, circle or ellipse")
    points = [point for _, row in drawn for curve in row for point in curve]
    size = max(max(p.real for p in points) - min(p.real for p in points),
               max(p.imag for p in points) - min(p.imag for p in points))  # fmt: skip
    if size > 0.0 and not 1.0 / LARGEST < size < LARGEST:
        raise ValueError(f"{path.name} is {size:g} wide or high, which is not between {1 / LARGEST:g} and {LARGEST:g}")
    far = max(max(abs(p.real), abs(p.imag)) for p in points)
    if 0.0 < size < RESOLVED * far:
        raise ValueError(f"{path.name} is {size:g} wide or high, and {far:g} from its origin: rounding takes its shape")
    found = [(name, polygon) for name, row in drawn if len(polygon := _polygon(row, CHORD * size)) > 2]
    if not found:
        raise ValueError(f"{path.name} has no path with an inside")
    corners = sum(len(polygon) for _, polygon in found)
    if corners > MOST_CORNERS:
        raise ValueError(f"{path.name} has {corners} corners, more than the {MOST_CORNERS} that an outline may have")
    found.sort(key=lambda item: -abs(area(item[1])))
    named: dict[str, Corners] = {}
    numbers: Counter[str] = Counter()
    for name, polygon in found:
        numbers[name] += 1
        named[name if numbers[name] == 1 else f"{name} {numbers[name]}"] = polygon
    return named


def area(polygon: Corners) -> float:
    """Signed area of a polygon, positive if counterclockwise."""
    following = (*polygon[1:], polygon[0])
    return 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(polygon, following, strict=True))


def _drawn(root: ElementTree.Element) -> list[tuple[str, list[Curve]]]:
    """Name and mapped curves of every path of the file. Raises ValueError."""
    drawn, count = [], 0
    for name, shape in _shapes(root, (1, 1j, 0), 0):
        for row in shape:
            count += len(row)
            if count > MOST_CURVES:
                raise ValueError(f"there are more than {MOST_CURVES} curves")
            if not all(abs(p.real) <= LARGEST and abs(p.imag) <= LARGEST for curve in row for p in curve):
                raise ValueError(f"'{_cut(name, SHOWN)}' has a point beyond {LARGEST:g}")
            drawn.append((name, row))
    return drawn


def _cut(text: str, length: int) -> str:
    """A text shortened to ``length`` characters, to be quoted in a message."""
    return text if len(text) <= length else f"{text[:length]}..."


def _shapes(node: ElementTree.Element, matrix: Matrix, depth: int) -> Iterator[tuple[str, list[list[Curve]]]]:
    """Yields (name, mapped curves by path) of an element and its descendants. Raises ValueError."""
    tag = str(node.tag).rpartition("}")[2]
    if tag in UNDRAWN:
        return
    if depth > DEEPEST:
        raise ValueError(f"groups are nested more than {DEEPEST} deep")
    matrix = _joined(matrix, _transform(node.get("transform", "")))
    data = _data(tag, node)
    if data:
        name = "".join(c if c.isalnum() else "_" for c in node.get("id", tag))
        yield name, [[tuple(_map(matrix, p) for p in curve) for curve in row] for row in curves(data)]  # type: ignore[misc]  # four stay four
    for child in node:
        yield from _shapes(child, matrix, depth + 1)


def _data(tag: str, node: ElementTree.Element) -> str:
    """An element's shape as path data; empty where it has none."""

    def number(name: str, default: float = 0.0) -> float:
        match = NUMBER.match(node.get(name, ""))
        found = float(match[0]) if match else default
        if not abs(found) <= LARGEST:
            raise ValueError(f"a {tag} has a {name} beyond {LARGEST:g}")
        return found

    if tag == "path":
        return node.get("d", "")
    if tag == "polygon":
        return f"M {node.get('points', '')} Z"
    if tag == "rect":
        return f"M {number('x')} {number('y')} h {number('width')} v {number('height')} h {-number('width')} Z"
    if tag in ("circle", "ellipse"):
        rx, ry = number("rx", number("r")), number("ry", number("r"))
        arc = f"a {rx} {ry} 0 0 1"
        return f"M {number('cx') - rx} {number('cy')} {arc} {2 * rx} 0 {arc} {-2 * rx} 0 Z"
    return ""


def _map(matrix: Matrix, z: complex) -> complex:
    return matrix[0] * z.real + matrix[1] * z.imag + matrix[2]


def _joined(outer: Matrix, inner: Matrix) -> Matrix:
    """The affine map that applies ``inner``, then ``outer``."""
    origin = (outer[0], outer[1], 0j)
    return _map(origin, inner[0]), _map(origin, inner[1]), _map(outer, inner[2])


def _transform(text: str) -> Matrix:
    """The affine map of a `transform` attribute. Raises ValueError for an unsupported one."""
    matrix: Matrix = (1, 1j, 0)
    text, at, steps = text.strip(), 0, 0
    while at < len(text):
        steps += 1
        if steps > MOST_TRANSFORMS:
            raise ValueError(f"a transform has more than {MOST_TRANSFORMS} steps")
        match = TRANSFORM.match(text, at)
        numbers = [float(n) for n in NUMBER.findall(match[2])] if match else []
        if not all(map(math.isfinite, numbers)):
            raise ValueError(f"the transform '{_cut(text[at:].strip(), SHOWN)}' has a number that is not finite")
        match (match[1] if match else "", numbers):
            case "matrix", [a, b, c, d, e, f]:
                step: Matrix = (complex(a, b), complex(c, d), complex(e, f))
            case "translate", [x, *y] if len(y) < 2:
                step = (1, 1j, complex(x, *y))
            case "scale", [x, *y]:
                step = (x, 1j * (y[0] if y else x), 0)
            case "rotate", [angle, *center] if len(center) in (0, 2):
                turn, about = cmath.rect(1.0, math.radians(angle)), complex(*center)
                step = (turn, 1j * turn, about - turn * about)
            case "skewX", [angle]:
                step = (1, complex(math.tan(math.radians(angle)), 1.0), 0)
            case "skewY", [angle]:
                step = (complex(1.0, math.tan(math.radians(angle))), 1j, 0)
            case _:
                raise ValueError(f"the transform '{_cut(text[at:].strip(), SHOWN)}' is not read")
        assert match is not None
        matrix = _joined(matrix, step)
        at = match.end()
    return matrix


def _polygon(row: list[Curve], tolerance: float) -> Corners:
    """Polygon of chords along consecutive curves, none farther than ``tolerance`` from its curve (Wang 1984); y up."""
    corners: list[complex] = []
    for a, b, c, d in row:
        bend = max(abs(a - 2 * b + c), abs(b - 2 * c + d))
        count = max(1, math.ceil(math.sqrt(0.75 * bend / tolerance))) if tolerance > 0.0 else 1
        if count > MOST_CORNERS:
            raise ValueError("a path has a curve that turns too much")
        for k in range(1, count + 1):
            t = k / count
            s = 1.0 - t
            corners.append(s * s * s * a + 3 * s * s * t * b + 3 * s * t * t * c + t * t * t * d)
    kept = [p for k, p in enumerate(corners) if abs(p - corners[k - 1]) > 1e-3 * tolerance]
    return tuple((p.real, -p.imag) for p in kept)
