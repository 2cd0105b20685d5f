"""Ties in chains, which are eliminated one by one: as the same ties in an order in which they are not."""

import numpy as np
import pytest

from sceneql.bodies.rigid.ties.tie_layout import CHAIN_AT
from sceneql.pipeline import load
from sceneql.run.run import Run

BODY = "mass: 1 kg, inertia: 0.1 0.2 0.15 kg*m^2"
SCENE = f"""
clock: {{end: 0.2 s}}
models:
  links:
    rigid:
      bodies:
        a: {{{BODY}, position: 0.5 0 0 m}}
        b: {{{BODY}, position: 1.5 0.2 0 m, spin: 0 0 1 rad/s}}
        c: {{{BODY}, position: 2 0 0.6 m}}
forces: [gravity]
ties:
TIES
solvers: {{main: {{dop853: {{tolerance: 1e-12}}}}}}
"""
OPEN = (
    "one: {hinge: {between: [links.a, world], at: 0 0 0 m}}",
    "two: {ball: {between: [links.a, links.b], at: 1 0 0 m}}",
    "three: {rod: {between: [links.c, links.b]}}",
)
HELD = (
    *OPEN[:2],
    "three: {weld: {between: [links.c, links.b]}}",
    "four: {ball: {between: [world, links.c], at: 2 0.7 1 m}}",
)
READ = ("links.a.position", "links.b.velocity", "links.c.position", "links.c.velocity", "one.force")


def moved(folder, ties, order):
    """Whether the ties are a chain, and what is read in the end."""
    path = folder / "scene.yaml"
    path.write_text(SCENE.replace("TIES", "\n".join(f"  {ties[k]}" for k in order)))
    run = Run(load(path, pruned=False))
    moment = run.at(0.2)
    return run.islands[0].assembly.tie_ints[CHAIN_AT] >= 0, [moment.read(*one.split(".", 1)) for one in READ]


@pytest.mark.parametrize("ties", [OPEN, HELD], ids=["open", "held"])
def test_chains_move_as_the_same_ties_do_in_an_order_that_is_none(tmp_path, ties):
    last = range(2, len(ties))
    chained, wanted = moved(tmp_path, ties, [1, 0, *last])
    assert not chained
    for order in ([0, 1, *last], [0, *reversed(last), 1]):
        chained, found = moved(tmp_path, ties, order)
        assert chained
        for value, other in zip(found, wanted, strict=True):
            np.testing.assert_allclose(value, other, rtol=1e-9, atol=1e-9)


def test_forces_that_die_away_along_a_chain_end_before_they_are_subnormal(tmp_path):
    # The inertia is nearly that of masses at the ends, so that a link hands on a five-hundredth of what pushes it.
    inertia, count = "1e-4 0.2505 0.2505 kg*m^2", 130
    bodies = [f"        c{k}: {{mass: 1 kg, inertia: {inertia}, position: {k + 0.5} 0 0 m}}" for k in range(count)]
    ties = ["  h0: {hinge: {between: [links.c0, world], at: 0 0 0 m}}"]
    ties += [f"  h{k}: {{hinge: {{between: [links.c{k}, links.c{k - 1}], at: {k} 0 0 m}}}}" for k in range(1, count)]
    lines = ["clock: {end: 0.01 s}", "models:", "  links:", "    rigid:", "      bodies:", *bodies]
    lines += ["forces: [gravity]", "ties:", *ties, "solvers: {main: {rk4: {step: 5 ms}}}"]
    path = tmp_path / "scene.yaml"
    path.write_text("\n".join(lines))
    run = Run(load(path, pruned=False))
    moment = run.at(0.01)
    assert run.islands[0].assembly.tie_ints[CHAIN_AT] >= 0
    forces = np.abs([moment.read(f"h{k}", "force") for k in range(count)])
    sizes = forces[forces > 0.0]
    assert sizes.max() > 1.0
    assert np.finfo(float).tiny <= sizes.min() < 1e-60
