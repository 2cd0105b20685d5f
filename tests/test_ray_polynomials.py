"""Single rays against polynomials, clipped by balls or not: what is told agrees with exact rational arithmetic."""

from __future__ import annotations

import pytest

from common_scenes import SCENES, rays, tape_of
from exact_rays import along, exact, first_entry, roots_of
from sceneql.field.roots.ray_polynomial_kernels import polynomial_root
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.plans import CLIP, NO_FORM, POLYNOMIAL, RADIUS, ray_plan
from sceneql.field.tape.tape_solid import scratch

RAYS = 120
SEXTIC = "(x^2 + 9/4*z^2 + y^2 - 1)^3 - x^2*y^3 - 9/80*z^2*y^3"
FORMULAS = {
    "barth": (SCENES["barth_sextic"]["f"], SCENES["barth_sextic"].get("where", {})),
    "steiner": (SCENES["steiner"]["f"], SCENES["steiner"].get("where", {})),
    "heart": (SEXTIC, {}),
    "octic": ("x^8 + y^8 + z^8 - (x*y*z)^2 - 0.3", {}),
    "sphere": ("3*(0.7 - x^2 - y^2 - z^2)", {}),
}
OUTSIDE = ("sphere", "barth")
"""Near the middle there is nothing of these."""
BALL = "x^2 + y^2 + z^2"


def solid(name, radius):
    """(tape, exact polynomials along a ray, of which all are negative inside)."""
    text, where = FORMULAS[name]
    clip = f"sqrt({BALL}) - {radius}"
    tape = tape_of(f"2*max({text}, {clip})" if radius else text, where)
    fields = [tape_of(text, where), *([tape_of(BALL)] if radius else [])]
    return tape, lambda *ray: [along(field, *ray) - (exact(radius) ** 2 if k else 0) for k, field in enumerate(fields)]


@pytest.mark.parametrize("radius", [0.0, 0.75, 1.0])
@pytest.mark.parametrize("name", FORMULAS)
def test_entries_ways_out_and_shadows_agree_with_exact_arithmetic(name, radius):
    tape, fields = solid(name, radius)
    plan, memory = ray_plan(tape), scratch(tape)
    assert plan[0] == POLYNOMIAL
    assert (plan[CLIP] >= 0) == (plan[RADIUS] >= 0) == (radius > 0)
    undecided = met = left = 0
    for origin, direction, t0, t1 in zip(*rays(1.1, RAYS, seed=7), strict=True):
        polynomials = fields(origin, direction)
        places = roots_of(*polynomials)

        def ask(begin, sign, anywhere, ray=(*origin, *direction), end=t1):
            return polynomial_root(
                tape.code, tape.constants, tape.parts, memory, plan, *ray, begin, end, sign, anywhere
            )  # fmt: skip

        def inside(t, polynomials=polynomials):
            return all(p(t) < 0 for p in polynomials)

        truth, place = first_entry(inside, places, t0, t1)
        status, t = ask(t0, 1.0, False)
        undecided += status == ops.UNDECIDED
        if status != ops.UNDECIDED:
            assert (status == ops.MISS) == (truth == "miss")
            assert truth == "miss" or t == pytest.approx(place, abs=1e-9)
        status, t = ask(t0, 1.0, True)
        undecided += status == ops.UNDECIDED
        assert status == ops.UNDECIDED or (status == ops.MISS) == (truth == "miss")
        if truth != "hit":
            continue
        met += 1
        # A hair behind its entry a ray is inside, or has left already.
        begin = place + 1e-6
        if not inside(exact(begin)):
            continue
        truth, place = first_entry(lambda t, p=polynomials: any(q(t) > 0 for q in p), places, begin, t1)
        status, t = ask(begin, -1.0, False)
        undecided += status == ops.UNDECIDED
        if status != ops.UNDECIDED:
            assert (status == ops.MISS) == (truth == "miss")
            assert truth == "miss" or t == pytest.approx(place, abs=1e-9)
            left += status == ops.HIT
    assert undecided <= 0.02 * RAYS
    assert met > 0.1 * RAYS or name in OUTSIDE
    assert left > 0.05 * RAYS or name in OUTSIDE


def test_rays_far_away_are_told_or_undecided_but_never_told_wrong():
    tape, fields = solid("barth", 1.0)
    plan, memory = ray_plan(tape), scratch(tape)
    told = 0
    for origin, direction, _, _ in zip(*rays(1.1, 60, seed=9), strict=True):
        far = origin - 1e4 * direction
        polynomials = fields(far, direction)
        t0, t1 = 9990.0, 10010.0
        truth, place = first_entry(lambda t, p=polynomials: all(q(t) < 0 for q in p), roots_of(*polynomials), t0, t1)
        status, t = polynomial_root(
            tape.code, tape.constants, tape.parts, memory, plan, *far, *direction, t0, t1, 1.0, False
        )
        if status != ops.UNDECIDED:
            told += 1
            assert (status == ops.MISS) == (truth == "miss")
            assert truth == "miss" or t == pytest.approx(place, abs=1e-6)
    assert told > 40


def test_a_ray_that_begins_inside_is_told_so():
    tape, _ = solid("sphere", 0.0)
    inverted = tape_of("x^2 + y^2 + z^2 - 0.7")
    for field, begin in ((tape, 2.0), (inverted, 0.0)):
        status, t = polynomial_root(
            field.code, field.constants, field.parts, scratch(field), ray_plan(field),
            begin, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 3.0, 1.0, False,
        )  # fmt: skip
        assert (status, t) == (ops.HIT, 0.0)
    status, _ = polynomial_root(
        tape.code, tape.constants, tape.parts, scratch(tape), ray_plan(tape),
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 3.0, -1.0, False,
    )  # fmt: skip
    assert status == ops.INSIDE


@pytest.mark.parametrize(
    "text", ["x^9 + y", "sin(x) + y^2", "x + y", "max(x^4 - y, z^3 - x)", "max(x^2 - y, y)", "min(x^2 - y, z^2 - x)"]
)
def test_what_has_no_such_form_is_left_to_enclosures(text):
    assert ray_plan(tape_of(text)).tolist() == [NO_FORM]
