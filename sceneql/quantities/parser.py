"""Text to unbound tree, by precedence climbing (Pratt 1973). Our own: a script's text is never run as Python."""

from __future__ import annotations

import re
from dataclasses import dataclass

from sceneql.quantities.diagnostic import Diagnostic, ScriptError, suggestion
from sceneql.quantities.expression import Call, Expr, Name, Number, Type, Vector
from sceneql.quantities.quick_operations import OPERATIONS
from sceneql.quantities.span import Span
from sceneql.quantities.quick_units import NAMES, Unit, read_unit

LONGEST, DEEPEST, MOST = 10_000, 100, 10_000
"""Characters, nesting and nodes of one expression."""

TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*'*(?:\.[^\W\d]\w*'*|\.\d+)*)"
    r"|(?P<op>\*\*|<=|>=|==|[-+*/^()\[\],<>])|(?P<end>$)|(?P<bad>.))",
    re.DOTALL,
)
BINARY = {
    "<": (1, "lt"), "<=": (1, "le"), ">": (1, "gt"), ">=": (1, "ge"), "==": (1, "eq"),
    "+": (2, "add"), "-": (2, "sub"), "*": (3, "mul"), "/": (3, "div"), "^": (5, "pow"), "**": (5, "pow"),
}  # fmt: skip
UNARY = 4
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
VECTOR = re.compile(rf"\s*({NUMBER}(?:\s+{NUMBER})+)(?:\s+(\S+))?\s*$")
RATIONAL = re.compile(rf"\s*({NUMBER})\s*/\s*((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s+(\S+)\s*$")


def parse_value(text: str, span: Span) -> Expr:
    """A whole scalar: ``2 kN/m``, ``1/60 s``, ``0 1.2 0 m``, or an expression. Raises ScriptError."""
    if len(text) <= LONGEST:
        vector = VECTOR.match(text)
        if vector is not None:
            unit = _whole_unit(vector[2], span, vector.start(2))
            items = tuple(
                _number(float(m[0]), unit, span.part(m.start(), m.end()))
                for m in re.compile(NUMBER).finditer(text, vector.start(1), vector.end(1))
            )
            return Vector(items, span=span)
        rational = RATIONAL.match(text)
        if rational is not None and float(rational[2]) != 0:
            unit = _whole_unit(rational[3], span, rational.start(3))
            return _number(float(rational[1]) / float(rational[2]), unit, span)
    return parse_expression(text, span)


def _whole_unit(text: str | None, span: Span, start: int) -> Unit | None:
    if text is None:
        return None
    read = read_unit(text)
    if read is None or read[1] != len(text):
        raise _unknown_unit(text, span.part(start, start + len(text)))
    return read[0]


def parse_expression(text: str, span: Span) -> Expr:
    """An expression. Raises ScriptError with one diagnostic at the very characters."""
    if len(text) > LONGEST:
        raise _error("expression-too-long", f"an expression may have {LONGEST} characters, not {len(text)}", span)
    return _Parser(text, span).whole()


@dataclass(slots=True)
class _Token:
    kind: str
    text: str
    start: int
    end: int


class _Parser:
    def __init__(self, text: str, span: Span) -> None:
        self.text, self.span = text, span
        self.nodes = 0
        self.previous = 0
        self.token = self._read(0)

    def whole(self) -> Expr:
        """The text from end to end."""
        expr = self.expression(0, 0)
        if self.token.kind != "end":
            self._leftover()
        return expr

    def expression(self, power: int, depth: int) -> Expr:
        """Operators that bind tighter than ``power``."""
        if depth > DEEPEST:
            raise self._fail("expression-too-deep", f"nested deeper than {DEEPEST}", self.token)
        start = self.token.start
        left = self.operand(depth)
        while self.token.kind == "op" and self.token.text in BINARY:
            binding, op = BINARY[self.token.text]
            if binding <= power:
                break
            self._advance()
            right = self.expression(UNARY - 1 if op == "pow" else binding, depth + 1)
            left = self._node(Call(op, (left, right), span=self._from(start)))
        return left

    def operand(self, depth: int) -> Expr:
        """A number, name, call, bracket or sign."""
        token = self.token
        if token.kind == "number":
            return self.literal()
        if token.kind == "name":
            self._advance()
            if self.token.text == "(" and self.token.kind == "op":
                return self.call(token, depth)
            return self._node(Name(tuple(token.text.split(".")), self.span.part(token.start, token.end)))
        if token.text in ("-", "+") and token.kind == "op":
            self._advance()
            inner = self.expression(UNARY, depth + 1)
            return inner if token.text == "+" else self._node(Call("neg", (inner,), span=self._from(token.start)))
        if token.text == "(":
            self._advance()
            inner = self.expression(0, depth + 1)
            self._close(")", token)
            return inner
        if token.text == "[":
            self._advance()
            items = self.items("]", token, depth)
            unit = read_unit(self.text, self._skip(self.previous))
            if unit is not None and self.token.kind == "name":
                inside = " ".join(part.strip() for part in self.text[token.end : self.previous - 1].split(","))
                name = self.text[self.token.start : unit[1]]
                raise self._fail(
                    "unit-after-bracket", "a unit cannot stand behind a bracket", self.token, f"write `{inside} {name}`"
                )
            return self._node(Vector(items, span=self._from(token.start)))
        if token.kind == "end":
            raise self._fail("syntax", "something is missing at the end", token)
        raise self._fail("syntax", f"'{token.text}' cannot stand here", token)

    def call(self, name: _Token, depth: int) -> Expr:
        """``name(...)``."""
        opening = self.token
        self._advance()
        args = self.items(")", opening, depth)
        operation = OPERATIONS.get(name.text)
        if operation is None:
            hint = suggestion(name.text, OPERATIONS)
            raise self._fail("unknown-function", f"there is no function '{name.text}'", name, hint)
        if not operation.least <= len(args) <= operation.most:
            counts = str(operation.least) if operation.least == operation.most else f"{operation.least} or more"
            raise self._fail("wrong-arity", f"{name.text} takes {counts} arguments, not {len(args)}", name)
        return self._node(Call(name.text, args, span=self._from(name.start)))

    def items(self, closing: str, opening: _Token, depth: int) -> tuple[Expr, ...]:
        """Expressions with commas up to the closing bracket."""
        result: list[Expr] = []
        if self.token.text == closing:
            self._advance()
            return ()
        while True:
            result.append(self.expression(0, depth + 1))
            if self.token.kind == "op" and self.token.text == ",":
                self._advance()
                continue
            self._close(closing, opening)
            return tuple(result)

    def literal(self) -> Expr:
        """A number, with the unit that stands directly after it."""
        token = self.token
        start = self._skip(token.end)
        value = float(token.text)
        read = read_unit(self.text, start)
        if read is not None:
            unit, end = read
            after = self.text[end : end + 1]
            if after not in ("(", ".", "_", "'") and not after.isalnum():
                self.previous = end
                self.token = self._read(end)
                return self._node(_number(value, unit, self._from(token.start)))
        self._advance()
        if self.token.kind == "name":
            name = self.token
            after = self.text[self._skip(name.end) : self._skip(name.end) + 1]
            if after != "(" and "." not in name.text:
                raise _unknown_unit(name.text, self.span.part(name.start, name.end), token.text)
        return self._node(_number(value, None, self._from(token.start)))

    # --- tokens ---

    def _read(self, at: int) -> _Token:
        found = TOKEN.match(self.text, at)
        assert found is not None
        kind = found.lastgroup or "end"
        if kind == "bad":
            raise self._fail("syntax", f"'{found['bad']}' cannot stand in an expression", _Token("bad", "", *found.span("bad")))
        return _Token(kind, found[kind], *found.span(kind))

    def _advance(self) -> None:
        self.previous = self.token.end
        self.token = self._read(self.token.end)

    def _skip(self, at: int) -> int:
        while at < len(self.text) and self.text[at].isspace():
            at += 1
        return at

    def _close(self, closing: str, opening: _Token) -> None:
        if self.token.kind == "op" and self.token.text == closing:
            self._advance()
            return
        if self.token.kind == "end":
            raise self._fail("syntax", f"'{opening.text}' is not closed", opening)
        self._leftover()

    def _leftover(self) -> None:
        token = self.token
        if token.kind in ("name", "number") or token.text in ("(", "["):
            raise self._fail("syntax", f"an operator is missing before '{token.text}'", token, "write `a*b` for a product")
        raise self._fail("syntax", f"'{token.text}' cannot stand here", token)

    def _node(self, expr: Expr) -> Expr:
        self.nodes += 1
        if self.nodes > MOST:
            raise self._fail("expression-too-long", f"more than {MOST} operations", self.token)
        return expr

    def _from(self, start: int) -> Span:
        return self.span.part(start, self.previous)

    def _fail(self, code: str, message: str, token: _Token, help: str | None = None) -> ScriptError:
        end = max(token.end, token.start + 1) if token.kind != "end" else token.start
        return _error(code, message, self.span.part(token.start, end), help)


def _number(value: float, unit: Unit | None, span: Span) -> Number:
    if unit is None:
        return Number(value, span=span)
    return Number(value * unit.scale + unit.offset, Type((), unit.dimension), False, span)


def _unknown_unit(text: str, span: Span, number: str = "") -> ScriptError:
    name = re.split(r"[*/·^]", text)[0]
    hint = suggestion(name, NAMES)
    if hint is None:
        hint = f"write `{number or '2'}*{text}` for a product"
    return _error("unknown-unit", f"'{text}' is no unit", span, hint)


def _error(code: str, message: str, span: Span, help: str | None = None) -> ScriptError:
    return ScriptError([Diagnostic(code, message, span, help)])
