"""Help for values that a part does not give under the name written: a height, a speed, an angle, an energy."""

from __future__ import annotations

from collections.abc import Callable, Collection

from sceneql.quantities.diagnostic import same_as

AXES = ("x", "y", "z")
COORDINATES = {
    "height": "y",
    "altitude": "y",
    "elevation": "y",
    "h": "y",
    "depth": "y",
    **dict(zip(AXES, AXES, strict=True)),
}
"""Names of a coordinate of a place, and its axis."""
SPEEDS = ("speed", "vel", "v", "absolute_velocity")
NATURE = {
    "g": "9.81 m/s^2",
    "G": "6.674e-11 m^3/(kg*s^2)",
    "c": "3e8 m/s",
    "k_B": "1.381e-23 J/K",
    "kB": "1.381e-23 J/K",
    "mu0": "1.257e-6 N/A^2",
    "eps0": "8.854e-12 C/(V*m)",
    "epsilon0": "8.854e-12 C/(V*m)",
    "hbar": "1.055e-34 J*s",
    "R_earth": "6371 km",
    "M_earth": "5.972e24 kg",
}
"""Constants of nature by their usual names, which a script defines itself."""
TURNS = ("angle", "theta", "phi", "rotation", "turn", "angles")
"""Names of the angle by which something is turned."""


def usual(name: str) -> str:
    """The value that a name is defined by in an example: that of a constant of nature, or a meter."""
    return NATURE.get(name, "1 m")


def output_alone(wanted: str, giving: Callable[[str], Collection[str]]) -> str | None:
    """The help for a height or a speed without the part that it is of: that of the first part with a place."""
    name = wanted.lower()
    output = "position" if name in COORDINATES else "velocity" if name in SPEEDS else ""
    part = next(iter(giving(output)), None) if output else None
    if part is None:
        return None
    value = f"{part}.position.{COORDINATES[name]}" if output == "position" else f"length({part}.velocity)"
    return f"a value is named with its part: write `{value}`"


def output_meant(
    part: str, wanted: str, outputs: Collection[str], giving: Callable[[str], Collection[str]]
) -> str | None:
    """The help for ``wanted``, which is none of a part's outputs; ``giving``: the parts that give an output."""
    *of, last = wanted.split(".")

    def known(name: str) -> str | None:
        whole = ".".join((*of, name))
        return f"{part}.{whole}" if whole in outputs else None

    position, velocity = known("position"), known("velocity")
    if last in COORDINATES and position is not None:
        return f"write `{position}.{COORDINATES[last]}`"
    if last in COORDINATES and not of and "center" in outputs:
        bodies = [one for one in outputs if one.endswith(".position")]
        first = f"of one mass it is `{part}.{bodies[0]}.{COORDINATES[last]}`, " if bodies else ""
        return f"{first}of all together `{part}.center.{COORDINATES[last]}`"
    if last == "velocity" and not of and position is not None:
        return "only what a model moves has one: write what it is by the formula, as `[1 m/s, 0 m/s, 0 m/s]`"
    if last in SPEEDS and velocity is not None:
        return f"write `length({velocity})`, or a component, `{velocity}.x`"
    if last[:1] in ("v", "a") and last[1:] in AXES:
        whole = velocity if last[:1] == "v" else known("acceleration")
        if whole is not None:
            return f"write `{whole}.{last[1:]}`"
    if last in TURNS and (ties := giving("angle")):
        return f"a hinge tells how far it has turned: write `{next(iter(ties))}.angle`"
    if last in TURNS and position is not None:
        return f"an angle is told by places: `atan2({position}.x, -{position}.y)` is that of a pendulum at the origin"
    if of and (one := same_as(last, outputs) or (last if last in outputs else None)) is not None:
        return f"it is told of all of '{part}' together: write `{part}.{one}`"
    if of and (others := [other for other in giving(wanted) if other != part]):
        return f"'{next(iter(others))}' gives it: write `{next(iter(others))}.{wanted}`"
    one = next((name for name in outputs if name.endswith(f".{wanted}")), None)
    many = f", or all of them, `{part}.{wanted}s`" if f"{wanted}s" in outputs else ""
    return None if one is None else f"it has bodies by name: write `{part}.{one}`{many}"
