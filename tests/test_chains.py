"""Long chains of links: what a link takes, and the same motion however the ties' matrix is stored."""

import numpy as np

import runs
from sceneql.pipeline import load
from sceneql.run.run import Run

INERTIA = "inertia: 1e-4 0.083333333333333333 0.083333333333333333 kg*m^2"


def chain(count, more_bodies="", more_ties=""):
    """Links of 1 m that hang from one end and start level."""
    bodies = "\n".join(f"        c{k}: {{{INERTIA}, position: {k + 0.5} 0 0 m}}" for k in range(count))
    ties = "\n".join(
        f"  h{k}: {{hinge: {{between: [links.c{k}, {f'links.c{k - 1}' if k else 'world'}], at: {k} 0 0 m}}}}"
        for k in range(count)
    )
    return f"""
clock: {{end: 0.3 s}}
models:
  links:
    rigid:
      mass: 1 kg
      bodies:
{bodies}
{more_bodies}
forces: [gravity]
ties:
{ties}
{more_ties}
solvers: {{main: {{dop853: {{tolerance: 1e-10}}}}}}
"""


def test_a_chain_moves_as_beside_a_body_on_a_tie_of_fewer_conditions(tmp_path):
    """Ties of as many conditions each make a matrix of blocks, others one of single entries: the motion is the same."""
    ball = f"        top: {{{INERTIA}, position: 0 5 0.5 m}}"
    ((alone,),) = runs.watch(tmp_path, chain(12), [0.3], "links.positions", pruned=False)
    mixed = chain(12, ball, "  pivot: {ball: {between: [links.top, world], at: 0 5 0 m}}")
    ((beside,),) = runs.watch(tmp_path, mixed, [0.3], "links.positions", pruned=False)
    assert beside[-1][1] < 4.99
    assert np.abs(alone[:, 1]).max() > 0.3
    np.testing.assert_allclose(beside[:-1], alone, rtol=0, atol=1e-9)


def test_a_link_takes_little_memory_which_is_what_bounds_a_long_chain(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(chain(60))
    run = Run(load(path, pruned=False))
    assembly = run.islands[0].assembly
    run.at(0.001)
    assert len(assembly.tie_ints) < 60 * 120
    assert len(run.islands[0].march.floats) < 60 * 640
