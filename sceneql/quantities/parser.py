"""Parser of expressions, by precedence climbing (Pratt 1973): text to unbound tree. A text is never run as Python."""

from __future__ import annotations

import re
from dataclasses import replace

from sceneql.quantities.diagnostic import Diagnostic, ScriptError, of_library, suggestion
from sceneql.quantities.expression import Call, Expr, Name, Number, Vector, children, each_once
from sceneql.quantities.instead import instead, rewritten
from sceneql.quantities.latex import from_latex
from sceneql.quantities.literal import (
    NUMBER,
    WORD,
    comma_meant,
    crossed,
    in_brackets,
    quantity,
    read_unit,
    vector_meant,
    whole_value,
    with_points,
)
from sceneql.quantities.operations import FUNCTIONS, MANY, OPERATIONS
from sceneql.quantities.other_words import LIBRARIES
from sceneql.quantities.spaced import (
    bracketed,
    by_frame,
    in_formula,
    indexed,
    meant_by_equals,
    modulo,
    named_by_dollar,
    other_signs,
    per_unit,
    ternary,
    two_ends,
    typed_plainly,
    vector_called,
    without_dots,
    without_lambda,
    written_out,
)
from sceneql.quantities.span import Span
from sceneql.quantities.temperatures import Temperatures
from sceneql.quantities.unit_table import UNITS
from sceneql.quantities.units import parse_unit

_WRITTEN = "×·⋅−⁻¹²³⁰"
COORDINATES = ("x", "y", "z")
LONGEST, DEEPEST = 10_000, 100
"""Limits on the number of characters of one expression (each node takes at least one), and on the depth of its tree."""

BINARY = {
    "<": (10, "lt"), "<=": (10, "le"), ">": (10, "gt"), ">=": (10, "ge"), "==": (10, "eq"),
    "+": (20, "add"), "-": (20, "sub"), "*": (30, "mul"), "/": (30, "div"), "^": (50, "pow"), "**": (50, "pow"),
}  # fmt: skip
SIGN = 40
TOKEN = re.compile(
    rf"\s*(?:(?P<number>{NUMBER})|(?P<name>{WORD})|(?P<sign>\*\*|//|<=|>=|==|[-+*/^()\[\],<>])|(?P<end>\Z)|(?P<bad>.))",
    re.DOTALL,
)

_PARENTHESES = re.compile(r"\(([^()]*,[^()]*,[^()]*)\)\s*([^\W\d]\S*)?")
_UNIT_IN_BRACKETS = re.compile(r"\[\s*([^\W\d][^\[\],]*?)\s*\]")


def parse_value(text: str, span: Span) -> Expr:
    """A whole scalar: ``2 kN/m``, ``1/60 s``, ``0 1.2 0 m``, or an expression. Raises ScriptError."""
    try:
        value = whole_value(text, span) if len(text) <= LONGEST else None
        return parse_expression(text, span) if value is None else value
    except ScriptError as error:
        (found,) = error.diagnostics
        if found.code == "unknown-unit" and (sides := crossed(text)) is not None:
            raise ScriptError([Diagnostic("syntax", "sizes have no 'x' between them", found.span, sides)]) from None
        if (chosen := ternary(text)) is not None and found.code == "unknown-unit":
            raise ScriptError([replace(found, help=f"write `{chosen}`")]) from None
        if (ends := two_ends(text)) is not None:
            help = f"two ends stand side by side, with one unit: write `{ends}`"
            raise ScriptError([replace(found, help=help)]) from None
        if (points := with_points(text, span)) is not None:
            help = f"a decimal number has a point: write `{points}`"
            raise ScriptError([replace(found, help=help)]) from None
        spaced = found.code in ("syntax", "unknown-unit") and len(text) <= LONGEST
        if not spaced or (vector := bracketed(text, span)) is None:
            raise
        help = f"a vector with formulas stands in brackets: write `{vector}`"
        raise ScriptError([Diagnostic("syntax", "two values stand side by side", found.span, help)]) from None


def parse_expression(text: str, span: Span) -> Expr:
    """An expression. Raises ScriptError with one diagnostic at the very characters; ``text`` stands at ``span``."""
    if len(text) > LONGEST:
        message = f"an expression has at most {LONGEST} characters, not {len(text)}"
        raise ScriptError([Diagnostic("expression-too-long", message, span, "give its parts names in `define`")])
    try:
        return _Parser(text, span).whole()
    except ScriptError as error:
        chosen = ternary(text) or without_lambda(text)
        if chosen is None or error.diagnostics[0].code not in ("syntax", "unknown-unit"):
            raise
        raise ScriptError([replace(error.diagnostics[0], help=f"write `{chosen}`")]) from None


class _Parser:
    def __init__(self, text: str, span: Span) -> None:
        self.text, self.span = text, span
        self.depth = 0
        self.before = ""
        self.previous = 0
        self.temperatures = Temperatures()
        self.kind, self.token, self.start, self.end = "", "", 0, 0
        self._read(0)

    def whole(self) -> Expr:
        """Parse the whole text. Raises ScriptError."""
        if self.kind == "end":
            raise self._fail("syntax", "an expression is missing here")
        expr = self._expression(0)
        if self.kind != "end":
            raise self._leftover(expr)
        depths: dict[int, int] = {}
        for node in each_once(expr):
            depths[id(node)] = 1 + max((depths[id(child)] for child in children(node)), default=0)
        if depths[id(expr)] > DEEPEST:
            raise self._too_deep(0, len(self.text))
        return expr

    def _expression(self, power: int) -> Expr:
        """Parse operators that bind tighter than ``power``."""
        self.depth += 1
        if self.depth > DEEPEST:
            raise self._too_deep(self.start, self.end)
        start = self.start
        left = self._operand()
        while self.kind == "sign" and self.token in BINARY:
            binding, op = BINARY[self.token]
            if binding <= power:
                break
            sign = self.start, self.end
            self._advance()
            right = self._expression(SIGN - 1 if op == "pow" else binding)
            whole = Call(op, (left, right), span=self._from(start))
            self.temperatures.combine(whole, left, right)
            left = whole
            if binding == 10 and self.kind == "sign" and BINARY.get(self.token, (0, ""))[0] == 10:
                raise self._fail("syntax", "comparisons do not chain", *sign, help="write `(a < b)*(b < c)`")
        self.depth -= 1
        return left

    def _operand(self) -> Expr:
        kind, token, start = self.kind, self.token, self.start
        if kind == "number":
            return self._number("")
        if kind == "name":
            self._advance()
            if self.token == "(":
                return self._call(token, start)
            return Name(tuple(token.split(".")), self._from(start))
        if token in ("-", "+") and kind == "sign":
            if self.before == "+" and token == "-" and start == self.previous:
                raise self._fail("syntax", "'+-' cannot stand here", start - 1, start + 1, help=instead("sign", "±"))
            self._advance()
            return self._signed(token, start)
        if token == "(":
            self._advance()
            expr = self._expression(0)
            self._close(")", start, expr)
            self._no_unit(start, None)
            return expr
        if token == "[":
            self._advance()
            items = self._items("]", start)
            if not items:
                raise self._fail("syntax", "an empty bracket has no value", start, self.previous)
            self._no_unit(start, items)
            return Vector(items, span=self._from(start))
        message = "something is missing at the end" if kind == "end" else f"'{token}' cannot stand here"
        if token == "/" and self.before == "+" and self.text[self.end : self.end + 1] == "-":
            raise self._fail("syntax", "'+/-' cannot stand here", start - 1, start + 2, help=instead("sign", "±"))
        angled = in_brackets(self.text, start) if token == "<" else None
        raise self._fail("syntax", message, help=None if angled is None else f"write `{angled}`")

    def _signed(self, sign: str, start: int) -> Expr:
        # A sign before a literal is part of it: -20 degC is 253.15 K, not minus 293.15 K.
        if self.kind == "number" and not self._raised():
            return self._number(sign, start)
        expr = self._expression(SIGN)
        if sign == "+":
            return expr
        whole = Call("neg", (expr,), span=self._from(start))
        self.temperatures.combine(whole, expr)
        if isinstance(expr, Number):
            return Number(-expr.value, expr.type, expr.bare, whole.span)
        return whole

    def _raised(self) -> bool:
        """Whether a power follows the number (and its unit): -2^2 is -(2^2)."""
        _, end = read_unit(self.text, self.end, self.span)
        following = TOKEN.match(self.text, end)
        return following is not None and following["sign"] in ("^", "**")

    def _number(self, sign: str, start: int | None = None) -> Expr:
        unit, end = read_unit(self.text, self.end, self.span)
        first = self.start if start is None else start
        number = quantity(sign + self.token, unit, self.span.part(first, end))
        if unit is not None and unit.shift != 0:
            self.temperatures.add(number, float(sign + self.token) * unit.scale)
        self.before, self.previous = self.text[first:end], end
        self._read(end)
        return number

    def _call(self, name: str, start: int) -> Expr:
        opening = self.start
        self._advance()
        args = self._items(")", opening)
        if name not in FUNCTIONS:
            vector = vector_called(self.text)
            hint = f"write `{vector}`" if vector else instead("function", name) or instead("function", of_library(name))
            hint = hint or suggestion(name, FUNCTIONS)
            if (anew := self._rewritten(name, args, opening)) is not None:
                raise self._fail("unknown-function", f"there is no function '{name}'", start, self.previous, help=anew)
            every = "`sceneql words functions` lists all"
            help = every if hint is None else f"{hint}{' ' if hint.endswith('?') else '; '}{every}"
            raise self._fail("unknown-function", f"there is no function '{name}'", start, start + len(name), help=help)
        operation = OPERATIONS[name]
        if not operation.takes(len(args)):
            low, high = operation.least, operation.most
            wanted = f"{low}" if low == high else f"{low} or more" if high == MANY else f"{low} to {high}"
            message = f"{name} takes {wanted} argument{'' if wanted == '1' else 's'}, not {len(args)}"
            better = self._rewritten(name, args, opening) or instead("function", name)
            raise self._fail("wrong-arity", message, start, self.previous, help=better)
        return Call(name, args, span=self._from(start))

    def _rewritten(self, name: str, args: tuple[Expr, ...], opening: int) -> str | None:
        """The help for a function of another language, whose bracket opens there."""
        texts, inside = [arg.span.text if arg.span else "" for arg in args], self.text[opening : self.previous]
        if "." in name and len(args) == 1 and name.partition(".")[0] not in LIBRARIES:  # its value at a time
            return f"write `at({name}, {texts[0] if texts[0][-1:].isalpha() else f'{texts[0]} s'})`"
        anew = rewritten(name, texts) if all(text in inside for text in texts) else None
        return f"write `{anew}`" if anew else None

    def _items(self, closing: str, opening: int) -> tuple[Expr, ...]:
        items: list[Expr] = []
        if self.token == closing:
            self._advance()
            return ()
        while True:
            items.append(self._expression(0))
            if self.token != ",":
                self._close(closing, opening, items[-1])
                return tuple(items)
            self._advance()

    # --- tokens and errors ---

    def _read(self, at: int) -> None:
        found = TOKEN.match(self.text, at)
        assert found is not None  # the last alternative takes any character
        self.kind = found.lastgroup or "end"
        self.token, (self.start, self.end) = found[self.kind], found.span(self.kind)
        if self.kind == "bad":
            message = f"'{self.token}' cannot stand in an expression"
            help = named_by_dollar(self.text, self.start) or instead("sign", self.token)
            if (self.token == "\\" or (self.token == "{" and self.before[-1:] in ("^", "_"))) and (
                plain := from_latex(self.text)
            ):
                help = f"write `{plain}`"
            if self.token in _WRITTEN and (plain := typed_plainly(self.text)) is not None:
                help = f"write `{plain}`"
            if self.token == "?" and (chosen := ternary(self.text)) is not None:
                help = f"write `{chosen}`"
            if self.token in "|%@":
                plain = modulo(self.text)
                help = other_signs(self.text) or (plain and f"write `{plain}`") or help
            if self.token in "=.":
                help = meant_by_equals(self.text) or without_dots(self.text) or help
            name = re.match(WORD, self.text[self.end :])
            if self.token == "$" and name is not None:
                own = name.group()
                help = f"a name stands by itself: write `{own}`, or `{own}*(1 cm)` where it is a plain number"
                help = by_frame(self.text, own, self.span.source.text) or help
            component = re.match(r"\.([xyz])\b", self.text[self.start :])
            if component is not None and self.before in (")", "]"):
                help = f"a component of an expression is written `component(..., {'xyz'.index(component[1])})`"
            raise self._fail("syntax", message, help=help)

    def _advance(self) -> None:
        self.before, self.previous = self.token, self.end
        self._read(self.end)

    def _close(self, closing: str, opening: int, last: Expr) -> None:
        if self.token == closing:
            self._advance()
        elif self.kind == "end":
            help = f"close it with `{closing}`"
            raise self._fail("syntax", f"'{self.text[opening]}' is not closed", opening, opening + 1, help=help)
        else:
            raise self._leftover(last)

    def _no_unit(self, opening: int, items: tuple[Expr, ...] | None) -> None:
        """Refuse a unit behind a bracket, with the corrected text as help."""
        if self.kind != "name" or self.token not in UNITS:
            return
        _, end = read_unit(self.text, self.start, self.span)
        inside = self.text[opening : self.previous]
        name = self.text[self.start : end]
        if items is not None and all(isinstance(item, Number) and item.bare for item in items):
            better = " ".join(part.strip() for part in inside[1:-1].split(",")) + f" {name}"
        else:
            better = f"{inside}*(1 {name})"
        message = "a unit stands directly after a number, not behind a bracket"
        raise self._fail("unit-after-bracket", message, self.start, end, help=f"write `{better}`")

    def _leftover(self, expr: Expr) -> ScriptError:
        if self.kind == "sign" and self.token not in "([":
            help = comma_meant(self.text) if self.token == "," else instead("sign", self.token)
            help = f"write `{plain}`" if (plain := modulo(self.text)) is not None else help
            if self.token == "," and (inner := _PARENTHESES.fullmatch(self.text.strip())) is not None:
                vector = vector_meant(f"{inner[1]}{' ' + inner[2] if inner[2] else ''}")
                help = help if vector is None else f"a vector has no parentheses: write `{vector}`"
            return self._fail("syntax", f"'{self.token}' cannot stand here", help=help)
        odd = next((c for c in self.text if not c.isascii() and instead("sign", c)), None)
        if odd is not None:
            at = self.text.index(odd)
            plain = typed_plainly(self.text) if odd in _WRITTEN else None
            help = instead("sign", odd) if plain is None else f"write `{plain}`"
            return self._fail("syntax", f"'{odd}' cannot stand in an expression", at, at + 1, help=help)
        if (sides := crossed(self.text) or (written_out(self.text) if self.token == "for" else None)) is not None:
            help = sides
        elif (vector := vector_called(self.text) or per_unit(self.text) or ternary(self.text)) is not None:
            help = f"write `{vector}`"
        elif isinstance(expr, Name) and (formula := instead("before", self.before)) is not None:
            help = formula
        elif isinstance(expr, Number) and self.kind == "number" and self.before.endswith("%"):
            help = instead("sign", "%")
        elif isinstance(expr, Number) and self.kind == "number":
            help = "a vector is numbers alone and one unit, `0 1.2 0 m`, or expressions in brackets, `[a, b, c]`"
            if (vector := vector_meant(self.text)) is not None:
                if vector == self.text.strip():  # right as a vector, but a formula stands here
                    *numbers, last = vector.split(" ")
                    unit = "" if last[-1:].isdigit() else f" {last}"
                    parse_unit(last, self.span) if unit else None  # raises where it is none, as km/hr
                    vector = f"[{', '.join(f'{one}{unit}' for one in (numbers if unit else (*numbers, last)))}]"
                help = f"write `{vector}`"
        elif self.kind == "number" and self.before[-1:].isdigit():
            help = in_formula(self.text)
        elif (meant := self._unit_behind(expr)) is not None:
            help = f"a unit stands directly after a number: write `{meant}`"
            if expr.span is not None and any(isinstance(n, Name) and n.parts != ("time",) for n in each_once(expr)):
                help += f", or `{expr.span.text}` where the name has a unit"
        elif isinstance(expr, Name) and (other := instead("digits", self.before)) is not None:
            help = other
        elif isinstance(expr, Name) and self.kind == "name" and self.token in UNITS:
            help = f"a unit stands directly after a number: write `{self.before}*(1 {self.token})`"
        elif self.token == "[" and (taken := indexed(expr, self.before, self.text, self.start)) is not None:
            help = taken
        elif isinstance(expr, Number) and (of := _UNIT_IN_BRACKETS.match(self.text, self.start)) is not None:
            help = f"a unit stands behind its number, without brackets: write `{self.before} {of[1]}`"
        elif self.kind == "name" and self.token in UNITS and expr.span is not None and expr.span.text[-1:] == ")":
            _, end = read_unit(self.text, self.start, self.span)
            unit = self.text[self.start : end]
            help = f"a unit stands directly after a number: write `{expr.span.text[:60]}*(1 {unit})`"
        elif self.before in FUNCTIONS and self.kind != "sign":
            help = f"write `{self.before}({self.token[:40]})`"
        elif (plain := from_latex(self.text)) is not None:
            help = f"write `{plain}`"
        elif (other := instead("name", self.token) or instead("name", self.before)) is not None and not (
            isinstance(expr, Name | Number) and {self.token, self.before} & {*COORDINATES}
        ):
            help = other
        else:
            help = f"write `{self.before[-40:]}*{self.token[:40]}` for a product"
        return self._fail("syntax", "two values stand side by side", help=help)

    def _unit_behind(self, expr: Expr) -> str | None:
        """The text most likely meant by ``0.2*time m/s``, whose unit belongs to the number before the product."""
        number = expr.args[0] if isinstance(expr, Call) and expr.op in ("mul", "div") else None
        if self.kind != "name" or self.token not in UNITS or not isinstance(number, Number) or not number.bare:
            return None
        _, end = read_unit(self.text, self.start, self.span)
        if self.text[end:].strip() or number.span is None or expr.span is None:
            return None
        written, whole = number.span.text, expr.span.text
        return f"{written} {self.text[self.start : end]}{whole[len(written) :]}" if whole.startswith(written) else None

    def _too_deep(self, start: int, end: int) -> ScriptError:
        help = f"give its parts names in `define`; a sum of more than {DEEPEST} terms is written `sum([a, b, ...])`"
        return self._fail("expression-too-deep", f"operations are nested deeper than {DEEPEST}", start, end, help=help)

    def _from(self, start: int) -> Span:
        return self.span.part(start, self.previous)

    def _fail(
        self, code: str, message: str, start: int | None = None, end: int | None = None, *, help: str | None = None
    ) -> ScriptError:
        first = self.start if start is None else start
        last = self.end if end is None else end
        return ScriptError([Diagnostic(code, message, self.span.part(first, last), help)])
