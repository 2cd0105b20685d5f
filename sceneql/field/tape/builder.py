"""A builder of tapes, straight-line code of a field: shares common subexpressions, folds constants, lowers powers."""

from __future__ import annotations

import math
from collections.abc import Generator, Mapping, Sequence
from typing import TYPE_CHECKING

from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.lowered_operations import FOLD, LOWERED
from sceneql.field.tape.whole_turns import up_to_whole_turns
from sceneql.quantities.expression import Call, Expr, Number, Symbol, recursive

if TYPE_CHECKING:
    from sceneql.field.skeleton.skeleton import Skeleton
    from sceneql.frame import Floats, Tape

Row = tuple[int, int, int, int]
COMMUTATIVE = {ops.ADD, ops.MUL, ops.MIN, ops.MAX}
WHOLE_OF_WHOLE = {ops.ADD, ops.SUB, ops.MUL, ops.MIN, ops.MAX, ops.NEG, ops.ABS, ops.SQUARE}
"""Operations that map whole numbers to whole numbers."""
LARGEST_POWER = 1024
"""Largest integer exponent of a power that is lowered to multiplications."""
FEW = 128
"""Most plain parts that are evaluated one by one (DENSITY); more are put into a hierarchy of boxes (SKELETON)."""


def computes(name: str) -> bool:
    """Whether a tape can compute a scalar operation."""
    return name in LOWERED or name in ops.UNARY or name in ops.BINARY


class TapeBuilder:
    """A tape under construction. Registers are integers; ``x``, ``y``, ``z`` hold the point at which f is evaluated."""

    def __init__(self) -> None:
        self._rows: list[Row] = [(ops.X, 0, 0, 0), (ops.Y, 0, 0, 0), (ops.Z, 0, 0, 0)]
        self._numbers: dict[Row, int] = {}
        self._constants: list[float] = []
        self._parts: list[Floats] = []
        self._part_rows = 0
        self._triples: dict[tuple[int, int, int], int] = {(0, 1, 2): 0}
        self.x, self.y, self.z = 0, 1, 2

    def _emit(self, row: Row) -> int:
        register = self._numbers.get(row)
        if register is None:
            register = self._numbers[row] = len(self._rows)
            self._rows.append(row)
        return register

    def constant(self, value: float) -> int:
        """Register of a number; equal numbers share one."""
        for index, known in enumerate(self._constants):
            if known == value and math.copysign(1.0, known) == math.copysign(1.0, value):
                return self._emit((ops.CONSTANT, index, 0, 0))
        self._constants.append(float(value))
        return self._emit((ops.CONSTANT, len(self._constants) - 1, 0, 0))

    def number(self, register: int) -> float | None:
        """The number in a constant register, else None."""
        op, index, _, _ = self._rows[register]
        return self._constants[index] if op == ops.CONSTANT else None

    def op(self, name: str, *registers: int) -> int:
        """Register of a scalar operation on registers. Raises ValueError for a name that no tape can compute.

        `min` and `max` take any number of registers. Comparisons, `step` and `where` are lowered to arithmetic, hence
        undefined where any argument is, even in the branch not taken. `a^b` with a varying exponent is defined for
        a > 0, and for a < 0 only where the exponent is known to be an integer.
        """
        if name in LOWERED:
            return LOWERED[name](self, *registers)
        if name in ops.UNARY:
            (a,) = registers
            return self._folded(name, (a,)) or self._emit((ops.UNARY[name], a, a, 0))
        if name not in ops.BINARY:
            raise ValueError(f"no tape operation is named {name!r}")
        if name in ("min", "max") and len(registers) != 2:
            first, *others = registers
            return self.op(name, first, self.op(name, *others)) if others else first
        a, b = registers
        if name == "pow":
            exponent = self.number(b)
            if exponent is None and not self._whole(b):
                return self.op("exp", self.op("mul", b, self.op("log", a)))
            lowered = self._power(a, exponent)
            if lowered is not None:
                return lowered
        simpler = self._folded(name, (a, b)) or self._simplified(name, a, b)
        if simpler is not None:
            return simpler
        code = ops.BINARY[name]
        if code in COMMUTATIVE and b < a:
            a, b = b, a
        return self._emit((code, a, b, 0))

    def _whole(self, register: int) -> bool:
        """Whether a register is known to hold integers wherever it is defined."""
        left, seen = [register], set()
        while left:
            k = left.pop()
            op, first, second, _ = self._rows[k]
            if op == ops.CONSTANT and self._constants[first].is_integer():
                continue
            if op in WHOLE_OF_WHOLE and k not in seen:
                left += first, second
            elif op not in (ops.FLOOR, ops.SIGN) and k not in seen:
                return False
            seen.add(k)
        return True

    def _folded(self, name: str, registers: tuple[int, ...]) -> int | None:
        """Register of the value of an operation on constants; None for other operands or a value that is not finite."""
        known = [value for value in map(self.number, registers) if value is not None]
        if len(known) < len(registers):
            return None
        try:
            value = FOLD[name](*known)
        except (ArithmeticError, ValueError):
            return None
        return self.constant(value) if math.isfinite(value) else None

    def _simplified(self, name: str, a: int, b: int) -> int | None:
        """Register of a simpler expression equal to a op b, also for NaN and infinity; None where there is none."""
        left, right = self.number(a), self.number(b)
        if name == "mul" and a == b:
            return self.op("square", a)
        if (name, left) in (("mul", 1.0), ("add", 0.0)):
            return b
        if (name, right) in (("mul", 1.0), ("div", 1.0), ("add", 0.0), ("sub", 0.0)):
            return a
        if name in ("min", "max") and a == b:
            return a
        if name == "mul" and right == -1.0:
            return self.op("neg", a)
        if name == "mul" and left == -1.0:
            return self.op("neg", b)
        if name == "div" and right not in (None, 0.0):
            return None if not math.log2(abs(right)).is_integer() else self.op("mul", a, self.constant(1.0 / right))
        return None

    def _power(self, a: int, exponent: float | None) -> int | None:
        """Register of a power by squares and products, with a root for half-integers; None for other exponents."""
        if exponent is None or self.number(a) is not None or abs(exponent) > LARGEST_POWER:
            return None
        if exponent < 0.0:
            positive = self._power(a, -exponent)
            return None if positive is None else self.op("div", self.constant(1.0), positive)
        whole = math.floor(exponent)
        if exponent - whole not in (0.0, 0.5):
            return None
        result = None if exponent == whole else self.op("sqrt", a)
        square = a
        while whole:
            if whole & 1:
                result = square if result is None else self.op("mul", result, square)
            whole >>= 1
            if whole:
                square = self.op("square", square)
        return self.constant(1.0) if result is None else result

    def expression(self, expr: Expr, symbols: Mapping[str, int]) -> int:
        """Register of a bound scalar expression whose symbols have registers in ``symbols``.

        Raises ValueError for an expression that is not scalar, KeyError for a symbol without a register.
        """

        def register(node: Expr) -> Generator[Expr, int, int]:
            match node:
                case Number(value=value):
                    return self.constant(value)
                case Symbol(name=name):
                    return symbols[name]
                case Call(op=name, args=args):
                    operands = []
                    for arg in args:
                        operands.append((yield arg))
                    return self.op(name, *operands)
            raise ValueError(f"{type(node).__name__} is no scalar of symbols and numbers")

        found: int = recursive(register, expr)
        return found

    def affine(self, matrix: Floats, x: int, y: int, z: int) -> tuple[int, int, int]:
        """Registers of the point (x, y, z) mapped by an affine matrix (3, 4)."""

        def row(numbers: Sequence[float]) -> int:
            total = self.constant(numbers[3])
            for register, number in zip((x, y, z), numbers, strict=False):
                if number != 0.0:
                    total = self.op("add", total, self.op("mul", register, self.constant(number)))
            return total

        first, second, third = (row([float(number) for number in numbers]) for numbers in matrix)
        return first, second, third

    def density(self, parts: Floats, x: int, y: int, z: int) -> int:
        """Register of the density of skeleton parts at a point: sum of weight (1 - d^2/R^2)^3 where d < R.

        ``parts`` (p, 8) [m]: ends a and b (a point has a = b), radius R, weight; d is the distance to the segment
        (Wyvill, McPheeters & Wyvill 1986).
        """
        return self._of_parts(ops.DENSITY, parts, x, y, z)

    def skeleton(self, skeleton: Skeleton, x: int, y: int, z: int) -> int:
        """Register of the density of a skeleton at a point; up to FEW plain parts become the cheaper DENSITY."""
        plain = skeleton.plain()
        if plain.sum() > FEW:
            plain[:] = False
        values = []
        if plain.any():
            values.append(self.density(skeleton.chosen(plain).density_rows(), x, y, z))
        if not plain.all():
            values.append(self._of_parts(ops.SKELETON, skeleton.chosen(~plain).rows(), x, y, z))
        if not values:
            return self.constant(0.0)
        return values[0] if len(values) == 1 else self.op("add", *values)

    def _of_parts(self, op: int, rows: Floats, x: int, y: int, z: int) -> int:
        """Register of an operation on rows (r, 8) of parts; the point is copied to three consecutive registers."""
        import numpy as np

        start = self._part_rows
        self._parts.append(np.asarray(rows, dtype=np.float64).reshape(-1, 8))
        self._part_rows += len(self._parts[-1])
        base = self._triples.get((x, y, z))
        if base is None:
            base = self._triples[x, y, z] = len(self._rows)
            self._rows.extend((ops.COPY, register, register, 0) for register in (x, y, z))
        self._rows.append((op, start, self._part_rows, base))
        return len(self._rows) - 1

    def finish(self, *registers: int) -> Tape:
        """The tape whose last rows are the given registers: one for f, three for paint. Drops unused operations."""
        import numpy as np

        from sceneql.frame import Tape

        if len(registers) > 1:
            self._rows.extend((ops.COPY, register, register, 0) for register in registers)
            registers = tuple(range(len(self._rows) - len(registers), len(self._rows)))
        needed = set(registers)
        for k in range(max(registers), -1, -1):
            if k in needed:
                needed.update(self._operands(k))
        kept = sorted(needed)
        place = {old: new for new, old in enumerate(kept)}
        numbers = sorted({self._rows[k][1] for k in kept if self._rows[k][0] == ops.CONSTANT})
        index = {old: new for new, old in enumerate(numbers)}
        code: list[Row] = []
        every = np.concatenate([np.empty((0, 8)), *self._parts])
        parts: list[Floats] = [np.empty((0, 8))]
        count = 0
        for k in kept:
            op, left, right, third = self._rows[k]
            if op == ops.CONSTANT:
                code.append((op, index[left], 0, 0))
            elif op in ops.OF_PARTS:
                code.append((op, count, count + right - left, place[third]))
                parts.append(every[left:right])
                count += right - left
            elif op in (ops.X, ops.Y, ops.Z):
                code.append((op, 0, 0, 0))
            else:
                code.append((op, place[left], place[right], self._twin(k, place)))
        known = {row: self._constants[numbers[left]] for row, (op, left, _, _) in enumerate(code) if op == ops.CONSTANT}
        for row in up_to_whole_turns(code, known, [place[register] for register in registers]):
            code[row] = (*code[row][:3], 1)
        return Tape(
            code=np.array(code, dtype=np.int32),
            constants=np.array([self._constants[old] for old in numbers], dtype=np.float64),
            parts=np.concatenate(parts),
        )

    def _twin(self, register: int, place: Mapping[int, int]) -> int:
        """For a sine (cosine), the finished tape's row of an earlier cosine (sine) of the same angle; 0 for none."""
        op, left, right, third = self._rows[register]
        if op not in (ops.SIN, ops.COS):
            return 0
        twin = self._numbers.get((ops.SIN + ops.COS - op, left, right, third), register)
        return place.get(twin, 0) if twin < register else 0

    def _operands(self, register: int) -> tuple[int, ...]:
        """The registers that an operation reads."""
        op, left, right, third = self._rows[register]
        if op in (ops.CONSTANT, ops.X, ops.Y, ops.Z):
            return ()
        return (third, third + 1, third + 2) if op in ops.OF_PARTS else (left, right)
