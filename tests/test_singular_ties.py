"""Ties that are singular at the start are told of; redundant ones, and those that move on, are not."""

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


@pytest.mark.parametrize(
    ("script", "told"),
    [
        (chain(2), True),
        (chain(5), True),
        (chain(4, rise=0.1), False),
        (chain(5, end=""), False),
        (chain(1, end="", more="\n  again: {hinge: {between: [world, it.p0], at: 0 0 0.1 m}}"), False),
    ],
    ids=["two", "five", "slack", "hanging", "two hinges of a door"],
)
def test_explain_tells_of_chains_that_are_taut(tmp_path, script, told):
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    assert ("singular at the start, as a chain that is taut" in text(explain(load(path)))) is told
