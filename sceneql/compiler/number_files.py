"""Reading of lists of numbers from files: ``{file: cloud.csv, columns: x y z, unit: mm}``."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

from sceneql.compiler.paths import read_path
from sceneql.kinds import Quantity, Value
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar
from sceneql.language.tree import Sequence as SequenceNode
from sceneql.quantities.diagnostic import Diagnostics, ScriptError, suggestion
from sceneql.quantities.dimension import PLAIN, Dimension
from sceneql.quantities.expression import Expr, Number, Type, Vector
from sceneql.quantities.span import Span
from sceneql.quantities.units import in_words, parse_unit

FIELDS = ("file", "columns", "unit")
TEXTS, ARRAYS = (".csv", ".tsv", ".txt"), (".npz", ".npy")
LARGEST = 64 << 20
"""Largest size of a file, unpacked [bytes]."""
MOST = 200_000
"""Largest number of rows of a file: as many as a skeleton may have parts."""
SHOWN = 24
"""Number of characters of a cell that a message quotes."""
Rows = list[list[float]]


class Wrong(Exception):
    """An error in a file, and its remedy."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.help = help


def names_a_file(node: Node, quantity: Quantity) -> bool:
    """Whether a node stands for a list of numbers in a file: a list may stand there, and it has the field `file`."""
    if quantity.shape is None:
        listed = quantity.dimension is not None
    else:
        listed = len(quantity.shape) > 0 and quantity.shape[0] is None
    return listed and isinstance(node, MappingNode) and "file" in node.entries


def read_numbers(
    node: Node, quantity: Quantity, what: str, folder: Path, files: list[str], found: Diagnostics
) -> Value | None:
    """The list in a file, a row for each item; None after reporting errors.

    Numbers are in SI where no unit is given. The path is appended to ``files``.
    """
    assert isinstance(node, MappingNode)
    ok = True
    for key in node.entries:
        if key not in FIELDS:
            hint = suggestion(key, FIELDS) or f"it has {', '.join(FIELDS)}"
            found.error("unknown-field", f"a list in a file has no field '{key}'", node.keys[key].span, help=hint)
            ok = False
    unit = _unit(node.entries.get("unit"), quantity.dimension, what, found)
    wanted = _columns(node.entries.get("columns"), found)
    path = read_path(node.entries["file"], folder, f"{what}.file", found)
    if path is None or unit is None or wanted is None or not ok:
        return None
    files.append(path)
    scale, dimension = unit
    try:
        rows = _rows(Path(path), quantity.shape, wanted)
    except Wrong as error:
        place = node.entries["columns" if isinstance(error.__cause__, LookupError) else "file"]
        found.error("file-numbers", f"{Path(path).name}: {error}", place.span, help=error.help)
        return None
    return Value(_vector(rows, quantity.shape, scale, dimension, node.span), node.span)


def _unit(
    node: Node | None, dimension: Dimension | None, what: str, found: Diagnostics
) -> tuple[float, Dimension] | None:
    """(factor to SI, dimension) of the file's numbers."""
    if node is None:
        return 1.0, dimension or PLAIN
    if not isinstance(node, Scalar):
        found.error("wrong-shape", "unit is a unit, such as `mm`", node.span)
        return None
    try:
        unit = parse_unit(node.text, node.content)
    except ScriptError as error:
        for diagnostic in error.diagnostics:
            found.add(diagnostic)
        return None
    if unit.shift or (dimension is not None and unit.dimension != dimension):
        message = f"{what} is {in_words(dimension)}, but this is {in_words(unit.dimension)}"
        found.error("dimension-mismatch", message, node.span)
        return None
    return unit.scale, unit.dimension


def _columns(node: Node | None, found: Diagnostics) -> list[str] | None:
    """Names or numbers of columns as written; empty: the first ones; None after reporting an error."""
    items = node.items if isinstance(node, SequenceNode) else [] if node is None else [node]
    if not all(isinstance(item, Scalar) for item in items):
        found.error("wrong-shape", "columns are names, or numbers from 1 on: `columns: x y z`", items[0].span)
        return None
    texts = [item.text for item in items if isinstance(item, Scalar)]
    if isinstance(node, Scalar):
        texts = node.text.replace(",", " ").split()
    return texts


def _rows(path: Path, shape: Sequence[int | None] | None, wanted: list[str]) -> Rows:
    """The chosen columns of a file. Raises Wrong, caused by a LookupError where the chosen columns are missing."""
    ending = path.suffix.lower()
    if ending not in (*TEXTS, *ARRAYS):
        raise Wrong(f"a list of numbers is in a file that ends in {', '.join((*TEXTS, *ARRAYS))}")
    width = None if shape is None else math.prod(size or 1 for size in shape[1:])
    try:
        if path.stat().st_size > LARGEST:
            raise Wrong(f"the file is larger than {LARGEST >> 20} MiB")
        rows = _of_text(path, width, wanted) if ending in TEXTS else _of_arrays(path, width, wanted)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise Wrong(f"it cannot be read: {error}") from error
    if not rows:
        raise Wrong("it has no rows of numbers")
    return rows


def _of_text(path: Path, width: int | None, wanted: list[str]) -> Rows:
    """Rows of a text table.

    Cells are separated by commas, semicolons, tabs or blanks; a first row may hold names; `#` begins a comment.
    """
    with path.open(encoding="utf-8-sig", newline="") as stream:
        lines = ((k, line.strip()) for k, line in enumerate(stream, 1))
        cells = _cells((k, line) for k, line in lines if line and not line.startswith("#"))
        _, first = next(cells, (0, []))
        if not first:
            return []
        heads = [] if all(map(_number, first)) else first
        chosen = _chosen(wanted, heads, len(first), width)
        rows: Rows = []
        if not heads:
            rows.append([_finite(first, column, 1) for column in chosen])
        for k, row in cells:
            if len(rows) == MOST:
                raise Wrong(f"it has more than {MOST:,} rows")
            rows.append([_finite(row, column, k) for column in chosen])
    return rows


def _cells(lines: Iterator[tuple[int, str]]) -> Iterator[tuple[int, list[str]]]:
    """(number, cells) of the lines of a table."""
    for k, line in islice(lines, 1):
        mark = next((mark for mark in ",;\t" if mark in line), None)
        yield k, _split(line, mark)
        for after, more in lines:
            yield after, _split(more, mark)


def _split(line: str, mark: str | None) -> list[str]:
    cells = line.split() if mark is None else next(csv.reader([line], delimiter=mark))
    return [cell.strip() for cell in cells]


def _number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _finite(row: list[str], column: int, line: int) -> float:
    if column >= len(row):
        raise Wrong(f"line {line} has {len(row)} columns, but column {column + 1} is asked for")
    cell = row[column]
    if not _number(cell) or not math.isfinite(float(cell)):
        raise Wrong(f"line {line}, column {column + 1}: '{cell[:SHOWN]}' is no finite number")
    return float(cell)


def _chosen(wanted: list[str], heads: list[str], count: int, width: int | None) -> list[int]:
    """Indices of the columns chosen by names or numbers among ``count``; by default the first ``width``, or all."""
    if not wanted:
        if width is not None and count < width:
            raise Wrong(f"it has too few columns: {count}, where {width} are needed")
        return list(range(width or count))
    if width is not None and len(wanted) != width:
        raise Wrong(f"{width} columns are needed, not {len(wanted)}") from LookupError()
    found = []
    for name in wanted:
        if name in heads:
            found.append(heads.index(name))
        elif name.isdecimal() and 1 <= int(name) <= count:
            found.append(int(name) - 1)
        else:
            hint = suggestion(name, heads) or (f"it has {', '.join(heads)}" if heads else None)
            raise Wrong(f"it has no column '{name}' among its {count}", hint) from LookupError()
    return found


def _of_arrays(path: Path, width: int | None, wanted: list[str]) -> Rows:
    """Rows of the only array of a file, or of the array named by ``wanted`` in an archive."""
    import numpy as np

    try:
        with path.open("rb") as stream:
            array = np.load(stream, allow_pickle=False)
            if path.suffix.lower() == ".npz":
                name = _member(list(array.files), wanted)
                if array.zip.getinfo(f"{name}.npy").file_size > LARGEST:
                    raise Wrong(f"'{name}' is larger than {LARGEST >> 20} MiB")
                array, wanted = array[name], []
        rows = np.asarray(array, dtype=float).reshape(len(array), -1)
    except (ValueError, TypeError, AttributeError, EOFError, KeyError, SyntaxError, ArithmeticError) as error:
        raise Wrong(f"it holds no array of numbers: {error}") from error
    except Exception as error:  # zipfile and zlib raise errors of their own
        if isinstance(error, Wrong | OSError | MemoryError):
            raise
        raise Wrong(f"it is no archive of arrays: {error}") from error
    if len(rows) > MOST:
        raise Wrong(f"it has more than {MOST:,} rows")
    if not np.isfinite(rows).all():
        raise Wrong(f"row {int(np.argwhere(~np.isfinite(rows))[0, 0]) + 1} has a number that is not finite")
    chosen = _chosen(wanted, [], rows.shape[1], width)
    if not wanted and width is not None and rows.shape[1] > width:
        raise Wrong(f"its rows have {rows.shape[1]} numbers, where {width} are needed")
    listed: Rows = rows[:, chosen].tolist()
    return listed


def _member(names: list[str], wanted: list[str]) -> str:
    """The name of the chosen array of an archive. Raises Wrong."""
    every = ", ".join(names)
    if len(wanted) > 1:
        raise Wrong("one array is needed: `columns` names it", f"it has {every}") from LookupError()
    if wanted and wanted[0] not in names:
        hint = suggestion(wanted[0], names) or f"it has {every}"
        raise Wrong(f"it has no array '{wanted[0]}'", hint) from LookupError()
    if not wanted and len(names) != 1:
        raise Wrong(f"it has {len(names)} arrays", f"choose one with `columns`: {every}")
    return (wanted or names)[0]


def _vector(rows: Rows, shape: Sequence[int | None] | None, scale: float, dimension: Dimension, span: Span) -> Expr:
    """The Vector of all rows: of numbers, of vectors, or of pairs of points."""
    inner = (len(rows[0]),) if shape is None else tuple(size or 1 for size in shape[1:])
    if shape is None and inner == (1,):
        inner = ()
    one = Type((), dimension)

    def nested(numbers: list[float], inner: tuple[int, ...]) -> Expr:
        if not inner:
            return Number(scale * numbers[0], one, False, span)
        each = len(numbers) // inner[0]
        items = tuple(nested(numbers[k : k + each], inner[1:]) for k in range(0, len(numbers), each))
        return Vector(items, Type(inner, dimension), span)

    return Vector(tuple(nested(row, inner) for row in rows), Type((len(rows), *inner), dimension), span)
