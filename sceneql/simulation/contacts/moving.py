"""Objects a little earlier or later, from which a moving surface's velocity is found."""

from __future__ import annotations

from dataclasses import replace

from sceneql.kinds import Object, Value
from sceneql.quantities.expression import TIME_SYMBOL, Call, Expr, Key, Keys, Number, Symbol, Vector


def is_moving(kind: Object) -> bool:
    """Whether any of its values varies in time."""
    return any(isinstance(value, Value) and not value.constant for _, value in kind)


def later(kind: Object, by: float) -> Object:
    """The object with every value taken ``by`` [s] later."""
    changed = {
        name: replace(value, expr=_later(value.expr, by))
        for name, value in kind
        if isinstance(value, Value) and not value.constant
    }
    return kind.model_copy(update=changed)


def _later(expr: Expr, by: float) -> Expr:
    match expr:
        case Symbol(name=name) if name == TIME_SYMBOL:
            return Call("add", (expr, Number(by, expr.type, False)), expr.type, expr.span)
        case Call(args=args):
            return replace(expr, args=tuple(_later(arg, by) for arg in args))
        case Vector(items=items):
            return replace(expr, items=tuple(_later(item, by) for item in items))
        case Keys(argument=argument, keys=keys):
            return replace(expr, argument=_later(argument, by), keys=tuple(_later_key(key, by) for key in keys))
    return expr


def _later_key(key: Key, by: float) -> Key:
    slopes = [None if slope is None else _later(slope, by) for slope in (key.slope_in, key.slope_out)]
    return Key(key.time, _later(key.value, by), *slopes)
