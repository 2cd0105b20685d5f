"""What steps of chosen length must not step over: keys, switches, the ends of pins, floors and moving objects."""

import math

import numpy as np
import pytest

from runs import watch
from sceneql.bodies.time_shift import goes_evenly
from sceneql.island.breakpoint_table import BreakpointTable, next_breakpoint
from sceneql.island.breakpoints import Breakpoints
from sceneql.pipeline import load
from sceneql.quantities.chance import random as chance
from sceneql.quantities.expression import Call, Key, Keys, Link, Number, Symbol, Type
from sceneql.run.run import Run

G = 9.81
TIME = Symbol("time", Type())
ADAPTIVE = ["auto", "{dopri5: {}}", "{dop853: {}}", "{gauss_radau15: {}}", "{radau: {}}", "{rodas5p: {}}"]
ADAPTIVE += ["{adams: {}}"]


def number(value):
    return Number(value, Type(), False)


def keys(argument=TIME, cycle=None):
    return Keys(argument, tuple(Key(number(t), number(t)) for t in (1.0, 2.5)), cycle=cycle)


def call(op, *args):
    return Call(op, args, Type())


def found(expr, end=10.0, formula=None):
    turns = Breakpoints(lambda link: formula, end)
    turns.follow(expr)
    assert not turns.beyond
    return sorted(turns.stops)


def instants(expr, end=10.0):
    """Those without a period, of ones that are as good as one the first."""
    times = [time for time, period in found(expr, end) if period == 0.0]
    return [time for k, time in enumerate(times) if k == 0 or time - times[k - 1] > 1e-12 * end]


def test_keys_and_switches_are_stops_whatever_they_stand_in():
    later = call("add", call("mul", number(2.0), TIME), number(0.5))
    linked = Link("lift", "progress", Type())
    assert found(keys()) == [(1.0, 0.0), (2.5, 0.0)]
    assert found(keys(later, number(4.0))) == [(0.25, 2.0), (1.0, 2.0)]
    assert found(keys(linked), formula=later) == [(0.25, 0.0), (1.0, 0.0)]
    switch = call("mul", number(3.0), call("gt", later, number(4.0)))
    assert instants(switch) == [pytest.approx(1.75, rel=1e-15)]
    assert instants(call("max", number(0.0), call("sub", TIME, number(3.0)))) == [pytest.approx(3.0, rel=1e-15)]
    assert found(keys(linked)) == []
    assert found(call("gt", Symbol("y", Type()), TIME)) == []
    assert found(call("mod", TIME, number(5e-324))) == []


def test_keys_over_what_falls_or_swings_are_stops():
    falling = call("sub", number(4.0), TIME)
    assert instants(keys(falling)) == pytest.approx([1.5, 3.0], rel=1e-15)
    assert [period for _, period in found(keys(falling, number(4.0)))] == [4.0, 4.0]
    swing = call("mul", number(2.0), call("sin", TIME))
    assert instants(keys(swing), 3.0) == pytest.approx([math.pi / 6, 5 * math.pi / 6], rel=1e-14)


def test_what_turns_inside_what_turns_is_found_however_short_it_lasts():
    since = call("abs", call("sub", TIME, number(3.005)))
    for width in (5e-3, 5e-9):
        pulse = call("lt", since, number(width))
        assert instants(pulse) == pytest.approx([3.005 - width, 3.005, 3.005 + width], abs=4e-15)
    rest = call("mod", TIME, number(1.0))
    expected = sorted([*range(1, 11), *(k + 1e-6 for k in range(10))])
    assert instants(call("lt", rest, number(1e-6)), 10.5) == pytest.approx([*expected, 10 + 1e-6], abs=1e-14)
    held = call("clamp", TIME, number(0.0), number(3.5))
    assert instants(call("gt", held, number(3.0))) == pytest.approx([3.0, 3.5], rel=1e-15)


def test_smooth_numbers_are_closed_in_on_where_they_cross_and_where_they_only_just_do():
    crest = call("gt", call("sin", TIME), number(1.0 - 5e-9))
    first = math.acos(1.0 - 5e-9)
    tops = [math.pi / 2, 5 * math.pi / 2]
    assert instants(crest) == pytest.approx([top + side * first for top in tops for side in (-1, 1)], abs=1e-11)
    square = call("pow", call("sub", TIME, number(3.1234567)), number(2.0))
    assert instants(call("lt", square, number(1e-10))) == pytest.approx([3.1234467, 3.1234667], abs=1e-11)
    assert instants(call("floor", call("pow", TIME, number(2.0))), 2.01) == pytest.approx(
        [1.0, math.sqrt(2.0), math.sqrt(3.0), 2.0], rel=1e-15
    )


def test_what_turns_more_often_than_can_be_kept_is_told():
    often = call("floor", call("mul", number(1e6), TIME))
    turns = Breakpoints(lambda link: None, 10.0)
    turns.follow(call("add", often, call("gt", TIME, number(3.0))))
    assert len(turns.beyond) == 1
    assert len(turns.stops) == 1


def test_the_next_stop_is_the_first_one_after_an_instant_and_periods_go_on():
    known = BreakpointTable.of([(2.5, 0.0), (math.nan, 0.0), (1.0, 0.0), (0.25, 2.0), (1.0 + 1e-15, 0.0), (-1.0, 0.0)])
    passed, time = [], 0.0
    while time < 7.0:
        time = next_breakpoint(known, time, 7.0)
        passed.append(time)
    assert passed == [0.25, 1.0, 2.25, 2.5, 4.25, 6.25, 7.0]


def test_the_next_of_many_stops_is_found_without_a_look_at_each():
    looks = 0

    class Counted(float):
        def __lt__(self, other):
            nonlocal looks
            looks += 1
            return float(self) < float(other)

        def __gt__(self, other):
            nonlocal looks
            looks += 1
            return float(self) > float(other)

    known = BreakpointTable(tuple(Counted(time) for time in range(1, 4097)))
    assert [next_breakpoint(known, float(time), 5000.0) for time in range(100)] == [
        float(time) for time in range(1, 101)
    ]
    assert looks < 100 * 20


@pytest.mark.parametrize("solver", ADAPTIVE)
def test_a_short_gust_after_long_calm_is_felt(tmp_path, solver):
    gust = "{keys: {0 s: 0 0 0, 3 s: 0 0 0, 3.05 s: 100 0 0, 3.1 s: 0 0 0}, curve: linear}"
    script = f"""
models: {{p: {{particles: {{list: {{a: {{position: 0 0 0}}}}}}}}}}
forces: [{{wind: {{velocity: {gust}, linear: 1 N*s/m}}}}]
solvers: {{main: {solver}}}
"""

    def ramp(t):
        return 2000 * (t - 1 + math.exp(-t))

    ((v,),) = watch(tmp_path, script, [4.0], "p.a.velocity")
    assert v[0] == pytest.approx(ramp(1.0) - 2 * ramp(0.95) + ramp(0.9), rel=1e-5)


def test_a_force_that_is_switched_on_and_off_is_felt(tmp_path):
    script = """
models: {p: {particles: {list: {a: {position: 0 0 0}}}}}
forces:
  gust:
    wind:
      velocity:
        - where(time > 3 s, where(time < 3.01 s, 1 km/s, 0 m/s), 0 m/s)
        - 0 m/s
        - 0 m/s
      linear: 1 N*s/m
"""
    ((v,),) = watch(tmp_path, script, [4.0], "p.a.velocity")
    assert v[0] == pytest.approx(1000 * (1 - math.exp(-0.01)) * math.exp(-0.99), rel=1e-6)


@pytest.mark.parametrize("solver", ADAPTIVE)
def test_switches_within_formulas_are_felt(tmp_path, solver):
    script = f"""
models:
  q: {{equations: {{start: {{y: 0}}, where: {{on: "t > 3"}}, rate: {{y: "on*where(time < 3.01, 700, 0)"}}}}}}
  p: {{particles: {{list: {{a: {{position: 0 0 0}}}}}}}}
forces: [{{force: {{components: "[where(t > 3, where(t < 3.01, 700, 0), 0), 0, 0]"}}}}]
objects: {{seen: {{sphere: {{radius: 1 m, position: [q.y, 0, 0]}}}}}}
solvers: {{main: {solver}}}
"""
    ((y, v),) = watch(tmp_path, script, [4.0], "q.y", "p.a.velocity")
    assert y == pytest.approx(7, rel=1e-9)
    assert v[0] == pytest.approx(7, rel=1e-9)


@pytest.mark.parametrize("solver", ADAPTIVE)
@pytest.mark.parametrize(
    ("force", "expected"),
    [
        ("where(mod(t, 1) < 0.01, 700, 0)", 280),
        ("where((t - 3.005)^2 < 0.005^2, 700, 0)", 7),
        ("350*(sign(t - 3) - sign(t - 3.01))", 7),
        ("where(clamp(t, 0, 3.5) > 3, where(clamp(t, 0, 3.5) < 3.01, 700, 0), 0)", 7),
        ("where(sin(2*pi*t/40) > 0.99999, 700, 0)", 700 * 2 * math.acos(0.99999) * 20 / math.pi),
    ],
)
def test_short_pulses_by_formulas_of_the_time_are_felt(tmp_path, solver, force, expected):
    script = f"""
clock: {{end: 40 s}}
models: {{p: {{particles: {{list: {{a: {{position: 0 0 0}}}}}}}}}}
forces: [{{force: {{components: "[{force}, 0, 0]"}}}}]
solvers: {{main: {solver}}}
"""
    ((v,),) = watch(tmp_path, script, [39.5], "p.a.velocity")
    assert v[0] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("solver", ["auto", "{dopri5: {}}", "{dop853: {}}", "{gauss_radau15: {}}", "{adams: {}}"])
def test_a_short_ramp_up_and_down_is_felt(tmp_path, solver):
    script = f"""
models: {{p: {{particles: {{list: {{a: {{position: 0 0 0}}}}}}}}}}
forces: [{{force: {{components: "[max(0, 700 - 70000*abs(t - 3)), 0, 0]"}}}}]
solvers: {{main: {solver}}}
"""
    ((v,),) = watch(tmp_path, script, [4.0], "p.a.velocity")
    assert v[0] == pytest.approx(7, rel=1e-9)


@pytest.mark.parametrize("solver", ["auto", "{radau: {}}"])
def test_a_pin_lets_go_at_its_time_however_long_nothing_moved(tmp_path, solver):
    masses = "{a: {position: 0 0 0, mass: 1 kg}, wall: {position: 1 0 0, fixed: yes}}"
    springs = "[{between: [a, wall], stiffness: 100 N/m, rest: 0.9 m}]"
    script = f"""
models: {{m: {{mass_spring: {{masses: {masses}, springs: {springs}, pins: {{a: {{until: 1 s}}}}}}}}}}
solvers: {{main: {solver}}}
"""
    before, later = watch(tmp_path, script, [0.7, 2.5], "m.a.position", "m.a.velocity")
    np.testing.assert_allclose(before, 0, atol=1e-12)
    assert later[0][0] == pytest.approx(0.1 * (1 - math.cos(15)), abs=1e-4)


@pytest.mark.parametrize("solver", [*ADAPTIVE, "{tr_bdf2: {}}", "{bdf2: {}}"])
def test_what_falls_on_a_floor_by_long_steps_bounces_as_it_must(tmp_path, solver):
    script = f"""
models: {{p: {{particles: {{list: {{a: {{position: 0 1 0, radius: 0 m}}}}}}}}}}
objects: {{floor: plane}}
forces: [gravity]
contacts: {{hit: {{collision: {{between: [p, floor], restitution: 0.8, mode: local}}}}}}
solvers: {{main: {solver}}}
"""
    hit = math.sqrt(2 / G)
    for row, t in zip(watch(tmp_path, script, [0.4, 0.6, 1.1], "p.a.position"), [0.4, 0.6, 1.1], strict=True):
        since = t - hit
        expected = 1 - G * t * t / 2 if since < 0 else 0.8 * G * hit * since - G * since**2 / 2
        assert row[0][1] == pytest.approx(expected, abs=5e-3 if "bdf2" in solver else 1e-6)


@pytest.mark.parametrize("mode", ["exact", "local"])
@pytest.mark.parametrize("curve", ["linear", "smooth"])
def test_what_falls_on_a_lift_by_long_steps_goes_up_with_it(tmp_path, mode, curve):
    height = f"{{keys: {{0 s: 0.2 m, 1.5 s: 0.2 m, 2.5 s: 1.2 m}}, curve: {curve}}}"
    script = f"""
models: {{p: {{particles: {{list: {{a: {{position: 0 1 0, radius: 0.1 m}}}}}}}}}}
objects: {{lift: {{box: {{size: 1 0.2 1 m, position: {{x: 0 m, z: 0 m, y: {height}}}}}}}}}
forces: [gravity]
contacts: {{hit: {{collision: {{between: [p, lift], restitution: 0.3, mode: {mode}}}}}}}
"""
    resting, end = watch(tmp_path, script, [1.4, 3.5], "p.a.position", "p.energy")
    np.testing.assert_allclose(resting[0], [0, 0.4, 0], atol=1e-9)
    np.testing.assert_allclose(end[0], [0, 1.4, 0], atol=1e-9)
    if curve == "smooth":  # the lift's work is that of lifting 1 kg by 1 m; a jolt tosses it up besides
        assert end[1] == pytest.approx(2 * G, abs=1e-4)


@pytest.mark.parametrize("height", ["1 mm/s*time - 1 m", "(time*1 mm/s - 2 m)/2 + time*0.5 mm/s"])
def test_what_an_even_lift_reaches_after_an_hour_takes_no_more_steps_for_that(tmp_path, height):
    script = f"""
clock: {{end: 3600 s}}
models: {{p: {{particles: {{list: {{a: {{position: 0 1 0, radius: 0.1 m}}}}}}}}}}
objects: {{lift: {{box: {{size: 1 0.2 1 m, position: [time*1 um/s, "{height}", 0 m]}}}}}}
contacts: {{hit: {{collision: {{between: [p, lift], restitution: 1, mode: exact}}}}}}
"""
    (tmp_path / "lift.yaml").write_text(script)
    run = Run(load(tmp_path / "lift.yaml"))
    for moment in run.moments([3600.0]):
        y = moment.read("p", "a.position")[1]
    assert y == pytest.approx(1 + 2e-3 * 1800, rel=1e-11)
    assert run.islands[0].march.statistics.steps < 100


def test_on_an_even_lift_all_goes_as_on_a_floor(tmp_path):
    ends = []
    for speed in (0.0, 2.0):
        script = f"""
models: {{p: {{particles: {{list: {{a: {{position: 0 1 0, velocity: 0.3 {speed} 0, radius: 0.1 m}}}}}}}}}}
objects: {{lift: {{plane: {{height: "time*{speed} m/s"}}}}}}
forces: [gravity]
contacts: {{hit: {{collision: {{between: [p, lift], restitution: 0.7, friction: 0.02, mode: exact}}}}}}
"""
        rows = watch(tmp_path, script, [0.7, 1.5, 4.0], "p.a.position")
        ends.append([row[0] - [0, speed * t, 0] for row, t in zip(rows, [0.7, 1.5, 4.0], strict=True)])
    np.testing.assert_allclose(ends[1], ends[0], rtol=0, atol=1e-9)


def test_only_what_is_a_line_in_the_time_goes_evenly():
    def call(op, *args):
        return Call(op, args, Type())

    linked = Link("lift", "height", Type())
    even = [number(2), TIME, call("sub", number(1), call("mul", number(2), TIME)), call("div", TIME, number(3)), linked]
    for expr in even:
        assert goes_evenly(expr, lambda link: call("neg", TIME))
    uneven = [call("mul", TIME, TIME), call("div", number(1), TIME), call("sin", TIME), call("min", TIME, number(2))]
    for expr in [*uneven, keys(), linked]:
        assert not goes_evenly(expr, lambda link: None)


def dragged():
    """x(1) of x'' = s^2 - 1e6 x' - 1e6 x from rest."""
    fast, slow = np.roots([1.0, 1e6, 1e6])
    c, b, a = 2e-6 - 2e-12, -2e-6, 1e-6
    first, second = np.linalg.solve([[1.0, 1.0], [fast, slow]], [-c, -b])
    return a + b + c + first * math.exp(fast) + second * math.exp(slow)


@pytest.mark.parametrize("solver", ["radau: {}", "rodas5p: {}", "radau: {tolerance: 1e-9}"])
@pytest.mark.parametrize(
    ("force", "end"),
    [
        ("max(0, 3*(t - 1))", 0.5),
        ("max(0, t - 1)^2", 1 / 12),
        ("max(0, t - 1)^3", 1 / 20),
        ("1e-9*max(0, t - 1)^5", 1e-9 / 42),
        ("where(t < 1, 0, 1e6*(t - 1)^2)", 1e6 / 12),
    ],
)
def test_stiff_solvers_follow_a_force_that_sets_in_on_a_state_at_rest(tmp_path, solver, force, end):
    """x'' = (t - 1)^n from t = 1 on, so that x = (t - 1)^(n + 2)/((n + 1)(n + 2))."""
    assert set_in(tmp_path, solver, force) == pytest.approx(end, rel=2e-6)


@pytest.mark.parametrize("word", ["radau", "rodas5p"])
def test_stiff_solvers_follow_a_force_that_sets_in_on_what_drags(tmp_path, word):
    """A free mass would be moved a million times as far, which is what is foreseen: so a tighter tolerance."""
    found = set_in(tmp_path, word + ": {tolerance: 1e-9}", "max(0, t - 1)^2 - 1e6*v - 1e6*x")
    assert found == pytest.approx(dragged(), rel=1e-6)


def set_in(tmp_path, solver, force):
    """x(2) from rest."""
    script = "clock: {end: 2 s}\nmodels: {e: {equations: {start: {x: 0, v: 0}, rate: {x: v, v: 'FORCE'}}}}\n"
    script += f"solvers: {{main: {{{solver}}}}}\noutputs: {{t: {{record: {{of: [e.x]}}}}}}\n"
    ((x,),) = watch(tmp_path, script.replace("FORCE", force), [2.0], "e.x")
    return x


@pytest.mark.parametrize("solver", ADAPTIVE)
@pytest.mark.parametrize(
    ("pulse", "area"),
    [
        ("exp(-1e6*(t - 1.0371)^2)", math.sqrt(math.pi) * 1e-3),
        ("exp(-((t - 1.5)/1e-3)^2/2)", math.sqrt(2 * math.pi) * 1e-3),
        ("1/cosh(1000*(t - 1))", math.pi * 1e-3),
    ],
)
def test_bells_are_seen_however_narrow(tmp_path, solver, pulse, area):
    """x' is 0 to rounding but for a thousandth of the run: the area under it, to a few of the tolerances 1e-6."""
    assert pulsed(tmp_path, solver, pulse) == pytest.approx(area, abs=2e-5)


@pytest.mark.parametrize("solver", [solver for solver in ADAPTIVE if "rodas5p" not in solver])
def test_bells_with_long_feet_are_seen(tmp_path, solver):
    """(The error that rodas5p estimates is blind to much of what the time alone drives: its manual says so.)"""
    area = 3e-3 * (math.atan(1370) + math.atan(630))
    assert pulsed(tmp_path, solver, "3/(1 + 1e6*(t - 0.63)^2)") == pytest.approx(area, abs=2e-5)


def pulsed(tmp_path, solver, pulse):
    """x(2) of x' = pulse."""
    script = f"clock: {{end: 2 s}}\nmodels: {{e: {{equations: {{start: {{x: 0}}, rate: {{x: '{pulse}'}}}}}}}}\n"
    script += f"solvers: {{main: {solver}}}\noutputs: {{t: {{record: {{of: [e.x]}}}}}}\n"
    ((x,),) = watch(tmp_path, script, [2.0], "e.x")
    return x


def test_every_one_of_several_bells_is_seen(tmp_path):
    script = "clock: {end: 3 s}\nmodels: {e: {equations: {start: {x: 0}, rate: {x: 'exp(-1e4*sin(pi*t)^2)'}}}}\n"
    script += "solvers: {main: {dopri5: {}}}\noutputs: {t: {record: {of: [e.x]}}}\n"
    ((x,),) = watch(tmp_path, script, [2.5], "e.x")
    assert x == pytest.approx(2.5 * math.sqrt(math.pi) * 1e-2 / math.pi, rel=1e-3)


@pytest.mark.parametrize("solver", ["auto", "{dop853: {}}", "{radau: {}}"])
def test_chance_by_the_clock_in_a_rate_is_new_with_each_tick(tmp_path, solver):
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 3 s}\nmodels: {m: {equations: {start: {x: 0}, rate: {x: 'random(floor(t), 7)'}}}}\n"
        f"solvers: {{main: {solver}}}\noutputs: {{table: {{record: {{of: [m.x]}}}}}}\n",
        encoding="utf-8",
    )
    run = Run(load(path))
    (island,) = run.islands
    island.advance(3.0)
    drawn = sum(chance(i, 7) for i in range(3))
    assert island.state("m").y[0] == pytest.approx(drawn, rel=1e-6)


def test_chance_in_a_source_is_compiled(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\nmodels: {m: {diffusion: {of: number, size: 1 1 m, cell: 0.25 m, coefficient: 0, "
        "source: 'random(floor(4*x), floor(4*y), 2)'}}}\noutputs: {table: {record: {of: [m.mean]}}}\n",
        encoding="utf-8",
    )
    (island,) = Run(load(path)).islands
    island.advance(1.0)
    drawn = [chance(i, j, 2) for j in range(4) for i in range(4)]
    assert island.state("m").y[:16] == pytest.approx(drawn, rel=1e-12)


PULSE = '"where((t > 3)*(t < 3.01), 100, 0)"'


@pytest.mark.parametrize(
    ("model", "output"),
    [
        (f"diffusion: {{coefficient: 0.01 m^2/s, initial: 0, source: {PULSE}, ", "field.mean"),
        (
            f"diffusion: {{coefficient: 0.01 m^2/s, initial: 0, boundary: {{left: {{flux: {PULSE}}}}}, ",
            "field.mean",
        ),
        (
            f"diffusion: {{method: elements, element: p1, coefficient: 0.01 m^2/s, initial: 0, source: {PULSE}, ",
            "field.mean",
        ),
        (
            f"reaction_diffusion: {{species: {{u: {{coefficient: 0.01 m^2/s, initial: 0, rate: {PULSE}}}}}, ",
            "field.u.mean",
        ),
    ],
)
def test_short_pulses_of_fields_are_felt(tmp_path, model, output):
    """Steps of chosen length went over a source of 10 ms in a field at rest, without a word."""
    script = f"models: {{field: {{{model}size: 1 1 m, cell: 0.25 m}}}}}}\nclock: {{end: 10 s}}\n"
    ((mean,),) = watch(tmp_path, script, [10.0], output)
    assert mean == pytest.approx(1.0, abs=1e-9)


def test_a_short_pulse_moves_water_as_a_whole(tmp_path):
    script = f"""
models: {{pond: {{wave: {{size: 1 1 m, cell: 0.25 m, speed: 1 m/s, source: {PULSE}}}}}}}
clock: {{end: 10 s}}
"""
    ((height,),) = watch(tmp_path, script, [10.0], "pond.mean")
    assert height == pytest.approx(10 - 3.005, abs=1e-8)


@pytest.mark.parametrize(
    ("expr", "leaps", "bends"),
    [
        (call("floor", call("div", TIME, number(4.0))), 4.0, 4.0),
        (call("abs", call("sub", TIME, number(3.0))), None, 3.0),
        (call("max", number(0.0), call("sub", call("sin", TIME), number(2.0))), None, None),
        (call("mul", TIME, TIME), None, None),
        (call("sin", call("mul", number(30.0), TIME)), None, None),
        (call("abs", call("pow", call("sub", TIME, number(3.0)), number(3.0))), None, None),
        (keys(), None, None),
    ],
    ids=["floor", "abs", "never", "square", "sine", "touching", "keys"],
)
def test_jumps_of_formulas_and_of_their_slopes_are_told(expr, leaps, bends):
    for wanted, bent in ((leaps, False), (bends, True)):
        at = Breakpoints(lambda link: None, 10.0).leap(expr, bends=bent)
        assert at == (wanted if wanted is None else pytest.approx(wanted, abs=1e-12))
