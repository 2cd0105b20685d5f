"""Ties that are singular at the start are told of; redundant ones, and those that move on, are not."""

import math

import pytest

from sceneql.pipeline import load
from sceneql.report.explain import explain, text


def chain(count, rise=0.0, end="world", more=""):
    """Planks of 1 m, end to end along x, that rise to the middle and fall behind it; hinges join them."""
    places, x, y = [], 0.0, 0.0
    for k in range(count):
        slope = rise if k < count / 2 else -rise
        size = (1 + slope**2) ** 0.5
        places.append((x, y, slope))
        x, y = x + 1 / size, y + slope / size
    objects = "\n".join(
        f"  p{k}: {{box: {{size: 1 0.05 0.3 m, position: {u + 0.5 / (1 + s * s) ** 0.5} "
        f"{v + 0.5 * s / (1 + s * s) ** 0.5} 0 m, rotation: {{about: z, angle: atan({s})}}}}}}"
        for k, (u, v, s) in enumerate(places)
    )
    bodies = ", ".join(f"p{k}: {{of: p{k}, mass: 1 kg}}" for k in range(count))
    ends = [*places, (x, y, 0)]
    names = ["world", *(f"it.p{k}" for k in range(count)), end]
    ties = "\n".join(
        f"  h{k}: {{hinge: {{between: [{names[k]}, {names[k + 1]}], at: {u} {v} 0 m}}}}"
        for k, (u, v, _) in enumerate(ends)
        if names[k + 1]
    )
    return f"""
objects:
{objects}
models: {{it: {{rigid: {{bodies: {{{bodies}}}}}}}}}
ties:
{ties}{more}
forces: [gravity]
outputs: {{rows: {{record: {{of: [it.energy]}}}}}}
"""


def linkage(lean, lengths=(1, 2, 1, 2)):
    """Two cranks, at an angle to the line of their pivots [deg], and the rod that joins their ends."""
    left, rod, right, apart = lengths
    turn = f"rotation: {{about: z, angle: {lean} deg}}"
    c, s = math.cos(math.radians(lean)), math.sin(math.radians(lean))
    return f"""
objects:
  a: {{box: {{size: {left} 0.05 0.3 m, position: {left / 2 * c} {left / 2 * s} 0 m, {turn}}}}}
  b: {{box: {{size: {rod} 0.05 0.3 m, position: {left * c + rod / 2} {left * s} 0 m}}}}
  c: {{box: {{size: {right} 0.05 0.3 m, position: {apart + right / 2 * c} {right / 2 * s} 0 m, {turn}}}}}
models: {{it: {{rigid: {{bodies: {{a: {{of: a}}, b: {{of: b}}, c: {{of: c}}}}}}}}}}
ties:
  h0: {{hinge: {{between: [world, it.a], at: 0 0 0 m}}}}
  h1: {{hinge: {{between: [it.a, it.b], at: {left * c} {left * s} 0 m}}}}
  h2: {{hinge: {{between: [it.b, it.c], at: {left * c + rod} {left * s} 0 m}}}}
  h3: {{hinge: {{between: [it.c, world], at: {apart} 0 0 m}}}}
forces: [gravity]
outputs: {{rows: {{record: {{of: [it.energy]}}}}}}
"""


@pytest.mark.parametrize(
    ("script", "told"),
    [
        (chain(2), "a chain that is taut"),
        (chain(5), "a chain that is taut"),
        (chain(4, rise=0.1), None),
        (chain(5, end=""), None),
        (chain(1, end="", more="\n  again: {hinge: {between: [world, it.p0], at: 0 0 0.1 m}}"), None),
        (linkage(0), "a linkage folded flat"),
        (linkage(90), None),
        (linkage(0, (1, 3, 0.5, 3.5)), "a linkage folded flat"),
        (linkage(0, (1, 3, 0.5, 4.5)).replace("at: 4.5 0 0 m", "at: 4.5 0 0.1 m"), "a chain that is taut"),
    ],
    ids=[
        "two",
        "five",
        "slack",
        "hanging",
        "two hinges of a door",
        "parallelogram",
        "open parallelogram",
        "bars of two sums alike",
        "stretched",
    ],
)
def test_explain_tells_of_ties_that_are_singular_and_in_which_way(tmp_path, script, told):
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    lines = [line.split("start, as ")[1] for line in text(explain(load(path))).splitlines() if "singular at" in line]
    assert lines == ([] if told is None else [told])
