"""The solver `equilibrium`: rests beside exact ones, limit loads, and what has no rest."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from sceneql.failure import LimitRefused, RunFailure
from sceneql.march import equilibrium_march
from sceneql.pipeline import load
from sceneql.run.run import IslandRun

G = 9.81
HALF, HEIGHT, STIFFNESS = 1.0, 0.1, 1e4
"""Of von Mises's truss: half its span and its height [m], the stiffness of its two bars [N/m]."""
AWAY, ACROSS = 50.0, 1e3
"""How far to both sides springs hold it in its plane [m], and their stiffness [N/m]."""


def run_of(folder, script, end=1.0, solver="equilibrium"):
    path = folder / "scene.yaml"
    path.write_text(f"{script}\nclock: {{end: {end} s}}\nsolvers: {{main: {solver}}}\n")
    graph = load(path, pruned=False)
    return IslandRun(graph, graph.islands[0])


def places(run, t, model="m"):
    bodies = run.bodies[model]
    y, _ = run.march.advance(t)
    return y[bodies.position_at : bodies.position_at + 3 * bodies.count].reshape(-1, 3)


def net(masses, springs, more=""):
    listed = ", ".join(f"{name}: {{position: {place} m{what}}}" for name, (place, what) in masses.items())
    return (
        f"models: {{m: {{mass_spring: {{mass: 1 kg, masses: {{{listed}}}, springs: [{', '.join(springs)}]{more}}}}}}}"
    )


FIXED = ", fixed: yes"


def chain(count, span, rest, stiffness, damping=0.0):
    masses = {f"p{k}": (f"{span * k / count} 0 0", FIXED if k in (0, count) else "") for k in range(count + 1)}
    law = f"rest: {rest} m, stiffness: {stiffness} N/m, damping: {damping} N*s/m"
    return net(masses, [f"{{between: [p{k}, p{k + 1}], {law}}}" for k in range(count)])


def hung(count, span, rest, stiffness):
    """(count + 1, 2) of the chain at rest: the pull along x is one for all springs, found so that they span it."""
    up = G * (np.arange(count) - (count - 1) / 2)

    def spring(pull):
        tension = np.hypot(pull, up)
        length = rest + tension / stiffness
        return np.column_stack([length * pull / tension, length * up / tension])

    pull = brentq(lambda pull: spring(pull)[:, 0].sum() - span, 1e-6, 1e6, xtol=1e-14, rtol=1e-15)
    return np.concatenate([[[0, 0]], np.cumsum(spring(pull), axis=0)])


@pytest.mark.parametrize(
    ("count", "rest", "stiffness", "damping"),
    [(10, 1.2, 1e5, 0), (10, 0.9, 1e3, 0), (7, 1.5, 1e8, 0), (40, 0.3, 2e4, 0), (10, 1.2, 1e5, 300)],
)
def test_a_chain_hangs_as_its_springs_pull(tmp_path, count, rest, stiffness, damping):
    span = 10.0
    script = chain(count, span, rest, stiffness, damping) + "\nforces: [gravity]"
    run = run_of(tmp_path, script)
    for t in (0.0, 0.3, 1.0):
        np.testing.assert_allclose(places(run, t)[:, :2], hung(count, span, rest, stiffness), rtol=0, atol=2e-8)
    bodies = run.bodies["m"]
    assert not run.march.advance(1.0)[0][bodies.velocity_at : bodies.work_at].any()


def truss(load):
    sides = {"a": (f"{-HALF} 0 0", FIXED), "b": (f"{HALF} 0 0", FIXED), "c": (f"0 {HEIGHT} 0", "")}
    sides |= {"front": (f"0 {HEIGHT} {AWAY}", FIXED), "back": (f"0 {HEIGHT} {-AWAY}", FIXED)}
    bars = [f"{{between: [{side}, c], stiffness: {STIFFNESS} N/m}}" for side in "ab"]
    bars += [f"{{between: [{side}, c], stiffness: {ACROSS} N/m}}" for side in ("front", "back")]
    return net(sides, bars) + f"\nforces: {{push: {{force: {{components: '[0, {load}, 0]'}}}}}}"


def resisted(height):
    """The load [N] under which the truss stands so high: by its bars, and by the springs that keep it in its plane."""
    bars = (np.hypot(HALF, HEIGHT) / np.hypot(HALF, height) - 1) * height
    return 2 * STIFFNESS * bars + 2 * ACROSS * (1 - AWAY / np.hypot(AWAY, HEIGHT - height)) * (HEIGHT - height)


def test_von_mises_truss_follows_its_exact_curve(tmp_path):
    run = run_of(tmp_path, truss("-t"), 3.8)
    for t in (0.0, 1.0, 2.2, 3.5, 3.8):
        high = HEIGHT if t == 0 else brentq(lambda y, t=t: resisted(y) - t, 0.0577, HEIGHT, xtol=1e-15)
        assert places(run, t)[2, 1] == pytest.approx(high, abs=1e-8)


def test_its_limit_load_ends_the_run(tmp_path):
    heights = np.linspace(0.05, 0.065, 100_001)
    limit = resisted(heights).max()
    run = run_of(tmp_path, truss("-t"), 9.0)
    with pytest.raises(RunFailure, match="a limit load is reached") as told:
        run.march.advance(9.0)
    assert told.value.time == pytest.approx(limit, rel=1e-7)
    assert told.value.part == "m"
    assert f"loads of {limit:.6g}" in told.value.message
    assert places(run, limit * (1 - 1e-6))[2, 1] == pytest.approx(heights[resisted(heights).argmax()], abs=1e-3)


def test_loads_that_jump_are_followed_by_the_rest_they_lead_to(tmp_path):
    """By 5 N, more than its limit load: it snaps through, and hangs as deep as it then resists."""
    run = run_of(tmp_path, truss("where(t > 0.5, -5, -1)"), 1.0)
    before, after = (
        brentq(lambda y, p=p: resisted(y) - p, *ends) for p, ends in ((1, (0.0577, 0.1)), (5, (-0.5, -0.1)))
    )
    assert places(run, 0.4)[2, 1] == pytest.approx(before, abs=1e-8)
    assert places(run, 0.8)[2, 1] == pytest.approx(after, abs=1e-8)


def test_led_pins_take_along_what_hangs_between_them(tmp_path):
    script = net(
        {"a": ("0 0 0", ""), "b": ("1 0 0", ""), "c": ("2 0 0", "")},
        ["{between: [a, b], rest: 0.5 m, stiffness: 100 N/m}", "{between: [b, c], rest: 0.5 m, stiffness: 100 N/m}"],
        ", pins: {a: {}, c: {shift: '[time*1 m/s, sin(2/s*time)*1 m, 0 m]'}}",
    )
    run = run_of(tmp_path, script)
    for t in (0.0, 0.37, 1.0):
        found = places(run, t)
        np.testing.assert_allclose(found[2], [2 + t, np.sin(2 * t), 0], atol=1e-9)
        np.testing.assert_allclose(found[1], found[2] / 2, atol=1e-8)


def test_a_column_ends_where_it_buckles(tmp_path):
    """A bar of 1 m upright on a hinge, its top held by a spring across of 50 N/m: stable up to 50 N."""
    script = net(
        {"foot": ("0 0 0", FIXED), "top": ("0 1 0", ""), "side": ("100 1 0", FIXED), "back": ("0 1 100", FIXED)},
        [
            "{between: [foot, top], stiffness: 1e7 N/m}",
            "{between: [side, top], stiffness: 50 N/m}",
            "{between: [back, top], stiffness: 90 N/m}",
        ],
    )
    run = run_of(tmp_path, script + "\nforces: {push: {force: {components: [0, -100*t, 0]}}}")
    with pytest.raises(RunFailure, match=r"unstable|limit load") as told:
        run.march.advance(1.0)
    assert told.value.time == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize("fall", ["", "\nforces: [gravity]"])
def test_what_nothing_holds_is_refused_with_its_free_motions(tmp_path, fall):
    script = net(
        {"a": ("0 0 0", ""), "b": ("1 0 0", ""), "c": ("0 1 0", "")}, ["{between: [a, b]}", "{between: [b, c]}"]
    )
    with pytest.raises(LimitRefused, match="nothing holds 'm': it is free to move along x, move along y, move along z"):
        run_of(tmp_path, script + fall).march.advance(0.0)


def test_a_field_has_no_rest_of_masses(tmp_path):
    script = "models: {heat: {diffusion: {size: 1 1 m, cell: 0.1 m, coefficient: 0.1 m^2/s, initial: x}}}"
    with pytest.raises(LimitRefused, match="'heat' has none"):
        run_of(tmp_path, script).march.advance(0.5)


@pytest.mark.parametrize("element", ["p1", "p2"])
def test_a_solid_held_across_its_planes_of_symmetry_alone_rests_and_one_that_slides_is_refused(tmp_path, element):
    holds = {
        axis: f"{axis}: {{where: {axis} < {end}, components: {axis}}}"
        for axis, end in {"x": -0.49, "y": -0.09, "z": -0.09}.items()
    }
    script = (
        "models: {m: {elastic: {block: {size: 1 0.2 0.2 m, cells: [3, 1, 1]}, law: {linear: {modulus: 20 kPa}}, "
        f"element: {element}, hold: {{HOLDS}}, loads: {{pull: {{where: x > 0.49, traction: 2 0 0 kPa}}}}}}}}}}"
    )
    run = run_of(tmp_path, script.replace("HOLDS", ", ".join(holds.values())))
    assert np.ptp(places(run, 1.0), axis=0) == pytest.approx([1.1, 0.2 * 0.97, 0.2 * 0.97])
    with pytest.raises(LimitRefused, match=r"it is free to move along x\n"):
        run_of(tmp_path, script.replace("HOLDS", f"{holds['y']}, {holds['z']}")).march.advance(1.0)


def test_a_rest_that_is_looked_for_is_broken_off_by_a_signal(tmp_path, monkeypatch):
    calls = []

    def interrupted(*args):
        calls.append(args)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return relax(*args)

    relax = equilibrium_march.relax
    monkeypatch.setattr(equilibrium_march, "relax", interrupted)
    with pytest.raises(KeyboardInterrupt):
        places(run_of(tmp_path, chain(8, 1.0, 0.1, 100.0) + "\nforces: [gravity]"), 0.0)
    assert len(calls) == 3
