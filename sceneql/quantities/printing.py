"""Trees and dimensions as text for people; an expression's text parses to the same tree again."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.quantities.dimension import Dimension
from sceneql.quantities.expression import Call, Expr, Keys, Link, Name, Number, Symbol, Vector

INFIX = {"lt": ("<", 1), "le": ("<=", 1), "gt": (">", 1), "ge": (">=", 1), "eq": ("==", 1)}
INFIX |= {"add": ("+", 2), "sub": ("-", 2), "mul": ("*", 3), "div": ("/", 3), "pow": ("^", 5)}

_NAMES: Mapping[str, str] = {
    "1": "a plain number",
    "m": "a length (m)",
    "s": "a time (s)",
    "kg": "a mass (kg)",
    "K": "a temperature (K)",
    "m^2": "an area (m^2)",
    "m^3": "a volume (m^3)",
    "m/s": "a velocity (m/s)",
    "m/s^2": "an acceleration (m/s^2)",
    "1/s": "a frequency (1/s)",
    "m*kg/s": "a momentum (kg*m/s)",
    "m*kg/s^2": "a force (N)",
    "kg/s^2": "a stiffness (N/m)",
    "kg/s": "a damping (N*s/m)",
    "m^2*kg/s^2": "an energy (J)",
    "m^2*kg/s^3": "a power (W)",
    "kg/m/s^2": "a pressure (Pa)",
    "kg/m^3": "a density (kg/m^3)",
}


def describe(dimension: Dimension | None) -> str:
    """A dimension in words: ``a stiffness (N/m)``."""
    return "a value" if dimension is None else _NAMES.get(str(dimension), f"a quantity in {dimension}")


def show(expr: Expr) -> str:
    """The text of a tree; numbers are written in SI."""
    return _show(expr, 0)


def _show(expr: Expr, power: int) -> str:
    match expr:
        case Number(value=value, type=type_):
            unit = "" if type_.dimension is None or type_.dimension.plain else f" {type_.dimension}"
            text = f"{value!r}{unit}"
            return f"({text})" if (value < 0 and power > 2) or (unit and power > 3) else text
        case Name(parts=parts):
            return ".".join(parts)
        case Symbol(name=name):
            return name
        case Link(task=task, output=output):
            return f"{task}.{output}"
        case Vector(items=items):
            return "[" + ", ".join(_show(item, 0) for item in items) + "]"
        case Keys():
            return "keys"
        case Call(op="neg", args=(arg,)):
            text = f"-{_show(arg, 4)}"
            return f"({text})" if power > 2 else text
        case Call(op=op, args=(a, b)) if op in INFIX:
            symbol, binding = INFIX[op]
            # Power groups to the right, the others to the left.
            left, right = (binding + 1, 4) if op == "pow" else (binding, binding + 1)
            text = f"{_show(a, left)} {symbol} {_show(b, right)}"
            return f"({text})" if binding < power else text
        case Call(op=op, args=args):
            return f"{op}({', '.join(_show(arg, 0) for arg in args)})"
    raise TypeError(f"cannot show {expr!r}")
