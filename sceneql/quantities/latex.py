r"""Formulas as LaTeX writes them, read for messages alone: ``\frac{1}{2} \cdot x^{2}`` is meant as ``1/2*x^2``."""

from __future__ import annotations

import re

from sceneql.quantities.unit_table import UNITS

_DROPPED = re.compile(r"\\(?:left|right|big|Big|,|;|!|:|quad|displaystyle)(?![a-zA-Z])|\$")
_GROUP = r"\{([^{}\\]*)\}"
_FRACTION = re.compile(rf"(\w?)(\s*)\\[dt]?frac\s*{_GROUP}\s*{_GROUP}")
_ROOT = re.compile(rf"\\sqrt\s*(?:\[([^\]]*)\])?\s*{_GROUP}")
_QUANTITY = re.compile(rf"\\(?:SI|qty)\s*{_GROUP}\s*{_GROUP}")
_PLAIN = re.compile(rf"\\(?:mathrm|mathbf|mathit|text|num|si|unit|operatorname|vec|hat|mbox)\s*{_GROUP}")
_POWER = re.compile(rf"([\^_])\s*{_GROUP}")
_PRODUCT = re.compile(r"\s*\\(?:cdot|times|ast)(?![a-zA-Z])\s*")
_CALLED = re.compile(r"\\(sin|cos|tan|exp|log|ln|sqrt)(?![a-zA-Z])\s*(?:\(|([\w.]+))")
_FACTOR_CALLED = re.compile(r"(?<=[\w)])\s*\\(?=(?:sin|cos|tan|exp|log|ln|sqrt)(?![a-zA-Z]))")
_NAME = re.compile(r"([\w)]?)(\s*)\\([a-zA-Z]+)")
_FACTOR = re.compile(r"(\s*)(?=[a-zA-Z0-9(]|\\(?!cdot|times|ast))([a-zA-Z]*)")
_SIDE = re.compile(r"(?<=[a-zA-Z])[ ](?=[a-zA-Z])(?<!\d [a-z])")
"""A space between two names, which stands for a product."""
_TOKEN = re.compile(r"[\w.]+")


def from_latex(text: str) -> str | None:
    """The formula that a text with commands or groups of LaTeX was meant as; None where that is not known."""
    before, result = "", _DROPPED.sub("", text)
    while before != result:
        before = result
        result = _QUANTITY.sub(r"\1 \2", result)
        result = _PLAIN.sub(r"\1", result)
        result = _POWER.sub(lambda one: one[1] + (one[2] if one[1] == "_" else _whole(one[2])), result)
        result = _ROOT.sub(_root, result)
        result = _FRACTION.sub(_fraction, result)
        result = _PRODUCT.sub("*", result)
        result = _FACTOR_CALLED.sub(r"*\\", result)
        result = _CALLED.sub(lambda one: f"{one[1]}({'' if one[2] is None else one[2] + ')'}", result)
        result = _NAME.sub(_name, result)
    result = re.sub(r"(?<![\w.])ln\(", "log(", " ".join(result.split()))
    result = re.sub(r"(?<=[\w)])\* (?=[\w(])", "*", result)
    result = _SIDE.sub("*", result) if _SIDE.search(result) is not None and result != text else result
    return None if result == text or re.search(r"[\\{}]", result) else result


def _fraction(found: re.Match[str]) -> str:
    over, under = found[3].strip(), found[4].strip()
    sign = "" if not found[1] else found[2] if over in UNITS else "*"
    before, after = found.string[: found.start()].rstrip(), found.string[found.end() :]
    text = f"{_whole(over)}/{_whole(under)}"
    if sign == "*" or (not found[1] and before.endswith(("/", "^"))) or after.lstrip().startswith("^"):
        text = f"({text})"
    return f"{found[1]}{sign or found[2]}{text}{_times(after, units=True)}"


def _times(after: str, *, units: bool = False) -> str:
    """The sign of a product where one is left out before ``after``; ``units``: it may begin with a unit."""
    factor = _FACTOR.match(after)
    return "" if factor is None or (units and factor[1] and factor[2] in UNITS) else "*"


def _root(found: re.Match[str]) -> str:
    text = f"sqrt({found[2]})" if found[1] is None else f"({found[2]})^(1/{found[1]})"
    return text + _times(found.string[found.end() :])


def _name(found: re.Match[str]) -> str:
    return f"{found[1]}{'*' if found[1] else found[2]}{found[3]}{_times(found.string[found.end() :])}"


def _whole(text: str) -> str:
    """A part of a formula that stands alone: in parentheses unless it is one name or number."""
    text = text.strip()
    return text if _TOKEN.fullmatch(text) else f"({text})"
