"""What a patch wrote is reported where the patch stands, not at the entry that it replaced."""

from __future__ import annotations

import pytest

from sceneql import pipeline

SCENE = """\
objects: {ball: sphere}
models:
  cage:
    mass_spring:
      masses: {a: {mass: 1 kg, fixed: yes}, b: {position: 1 0 0 m, velocity: 1 0 0 m/s}}
      springs: {between: [a, b], stiffness: 1 kN/m}
clock: {end: 3 s}
solvers:
  march: {rk4: {step: 1 ms}}
variants:
  whole:
    solvers.march: {semi_implicit_euler: {step: 100 ms}}
  step:
    solvers.march.step: 1 s
  word:
    solvers.march.rk4: {step: 1 s}
"""


def warned(tmp_path, **options):
    """The place of the only warning, and the text that its caret marks."""
    path = tmp_path / "cage.yaml"
    path.write_text(SCENE)
    (warning,) = pipeline.load(path, **options).warnings
    assert warning.code == "unstable-step"
    return (warning.span.source.name, warning.span.line), warning.span.text


@pytest.mark.parametrize(
    ("variant", "line", "marked"), [("whole", 12, "100 ms"), ("step", 14, "1 s"), ("word", 16, "1 s")]
)
def test_a_warning_marks_the_step_in_the_variant(tmp_path, variant, line, marked):
    (name, at), text = warned(tmp_path, variant=variant)
    assert name.endswith("cage.yaml")
    assert (at, text) == (line, marked)


def test_a_warning_marks_the_step_in_the_option(tmp_path):
    assert warned(tmp_path, sets=["solvers.march.step=2 s"]) == (("--set", 1), "2 s")


@pytest.mark.parametrize(("variant", "line"), [(None, 9), ("step", 9), ("whole", 12)])
def test_a_part_stands_where_it_was_last_written_whole(tmp_path, variant, line):
    path = tmp_path / "cage.yaml"
    path.write_text(SCENE)
    assert pipeline.load(path, variant=variant).tasks["march"].span.line == line
