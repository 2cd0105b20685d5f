"""Units: our table and grammar against pint, and the texts that must be refused."""

from __future__ import annotations

import math
from fractions import Fraction

import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import examples
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.dimension import FORCE, LENGTH, PLAIN, STIFFNESS, TIME, Dimension
from sceneql.quantities.unit_table import KNOWN_UNITS, OFFSET_UNITS, QUANTITIES, SINGLE, UNITS
from sceneql.quantities.units import describe, format_quantity, parse_unit, unit_of

PINT = pint.UnitRegistry()
BASE = ("meter", "kilogram", "second", "ampere", "kelvin", "mole", "candela")
IN_PINT = {"%": "percent", "day": "day", "h": "hour", "mph": "mile/hour", "C": "coulomb", "F": "farad"}


BASES = {row[0] for row in SINGLE}
PREFIX_IN_PINT = {
    "f": "femto", "p": "pico", "n": "nano", "u": "micro", "µ": "micro", "μ": "micro", "m": "milli", "c": "centi",
    "d": "deci", "h": "hecto", "k": "kilo", "M": "mega", "G": "giga", "T": "tera", "P": "peta",
}  # fmt: skip


def of_pint(name: str) -> str:
    """In pint's own full names for prefixes: pint takes ``mcd`` for a microday."""
    if name in BASES:
        return f"({IN_PINT.get(name, name)})"
    return f"({PREFIX_IN_PINT[name[0]]}{IN_PINT.get(name[1:], name[1:])})"


def dimension_in_pint(quantity: pint.Quantity) -> Dimension:
    powers = dict(quantity.to_base_units().unit_items())
    powers.pop("radian", None)
    assert set(powers) <= set(BASE)
    return Dimension(tuple(Fraction(powers.get(base, 0)).limit_denominator(100) for base in BASE))


@pytest.mark.parametrize("name", UNITS)
def test_every_unit_is_what_pint_says(name: str) -> None:
    unit = parse_unit(name)
    wanted = PINT.Quantity(1.0, of_pint(name))
    assert unit.dimension == dimension_in_pint(wanted)
    assert unit.scale == pytest.approx(wanted.to_base_units().magnitude, rel=1e-10)


factors = st.tuples(st.sampled_from(list(UNITS)), st.integers(-3, 3).filter(bool), st.sampled_from(["*", "/", "·"]))


@given(st.lists(factors, min_size=1, max_size=4), st.booleans())
@settings(max_examples=examples(300))
def test_a_product_of_units_is_what_pint_says(parts: list[tuple[str, int, str]], spaced: bool) -> None:
    gap = " " if spaced else ""
    text, theirs = "", "1"
    for name, power, sign in parts:
        joint = sign if text else ""
        text += f"{gap}{joint}{gap}{name}" + ("" if power == 1 else f"^{power}")
        theirs += f"{'/' if joint == '/' else '*'}{of_pint(name)}**{power}"
    wanted = PINT.Quantity(1.0, theirs)
    scale = wanted.to_base_units().magnitude
    if not 1e-300 < scale < 1e300:  # no double may hold it, or a step to it
        return
    unit = parse_unit(text)
    assert unit.dimension == dimension_in_pint(wanted)
    assert unit.scale == pytest.approx(scale, rel=1e-9)


@given(st.floats(-1000, 1000))
def test_temperatures_have_their_zero(value: float) -> None:
    for ours, theirs in (("degC", "degC"), ("degF", "degF")):
        wanted = PINT.Quantity(value, theirs).to("kelvin").magnitude
        assert parse_unit(ours).to_si(Fraction(value)) == pytest.approx(wanted, rel=1e-12, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "code", "help"),
    [
        ("kn", "unknown-unit", "kN"),
        ("metre", "unknown-unit", None),
        ("m²", "unknown-unit", "m^2"),
        ("degC/s", "offset-unit", "K"),
        ("J/degC", "offset-unit", "K"),
        ("degC^2", "offset-unit", "K"),
        ("m/", "syntax", None),
        ("", "syntax", None),
        ("m^x", "syntax", None),
        ("m^0.5", "syntax", None),
        ("m^99", "syntax", None),
        ("m^(1/0)", "syntax", None),
        ("m kg", "syntax", None),
        ("Mpc^20*Mpc^20", "syntax", None),
    ],
)
def test_refused(text: str, code: str, help: str | None) -> None:
    with pytest.raises(ScriptError) as caught:
        parse_unit(text)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == code
    if help is not None:
        assert help in (diagnostic.help or "")


def test_no_likely_name_of_a_script_is_a_unit() -> None:
    for name in ("dt", "dx", "dy", "x", "y", "z", "k", "e", "r", "n", "theta", "mu", "rho", "l", "phi", "ds", "dv"):
        assert name not in KNOWN_UNITS, name


exponents = st.builds(Fraction, st.integers(-4, 4), st.integers(1, 3))


@given(st.tuples(*[exponents] * 7), st.floats(allow_nan=False, allow_infinity=False))
def test_a_shown_quantity_reads_back(powers: tuple[Fraction, ...], value: float) -> None:
    dimension = Dimension(powers)
    if dimension.plain:
        assert float(format_quantity(value, dimension)) == value
        return
    number, unit = format_quantity(value, dimension).split(" ")
    assert float(number) == value
    assert parse_unit(unit).dimension == dimension
    assert parse_unit(unit).ratio == 1


def test_shown_units_are_coherent_and_named_once() -> None:
    units = [parse_unit(text) for text, _ in QUANTITIES]
    assert all(unit.ratio == 1 for unit in units)
    assert len({unit.dimension for unit in units}) == len(units)


def test_words_for_messages() -> None:
    assert format_quantity(1000.0, STIFFNESS) == "1000 N/m"
    assert unit_of(FORCE * TIME / LENGTH) == "N*s/m"
    assert describe(LENGTH) == "a length (m)"
    assert describe(PLAIN) == "a plain number"
    assert describe(LENGTH**5) == "a quantity (m^5)"


@given(st.decimals(min_value=0, max_value=10**6, places=4))
def test_a_decimal_in_a_metric_unit_is_the_nearest_double(number: object) -> None:
    exact = Fraction(str(number))
    for name in ("mm", "km", "us", "kN", "g"):
        assert parse_unit(name).to_si(exact) == float(exact * UNITS[name][0])
    assert math.isfinite(parse_unit("mm").to_si(exact))
    assert set(OFFSET_UNITS) <= set(KNOWN_UNITS)


@pytest.mark.parametrize("text", ["1 m/(2*h)", "1 m/(1 - s)", "3 kg/(2 + s)"])
def test_below_a_bar_beside_a_number_a_name_is_no_unit(tmp_path, text):
    (tmp_path / "scene.yaml").write_text(f'define: {{a: "{text}"}}\nobjects: {{b: {{sphere: {{radius: a}}}}}}\n')
    with pytest.raises(ScriptError) as caught:
        load(tmp_path / "scene.yaml")
    assert caught.value.diagnostics[0].code == "unknown-name"
