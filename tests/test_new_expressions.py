"""A changed number, another time and a new formula compile nothing: fields are data."""

from __future__ import annotations

import pytest

from sceneql import pipeline
from sceneql.compiled.kernels import compiled

SCENE = """\
sceneql: 1
define: {k: 0.5}
clock: {end: 1 s}
objects:
  a: {implicit: {field: "FIELD", bounds: {ball: 1}, mode: MODE}}
outputs: {still: {image: {size: 16 9, renderer: RENDERER, time: 1 s}}}
"""
KNOWN = [
    "y^2 + z^2 + 2*x^2 - k",
    "cos(7*x)*sin(8*y) - cos(9*z)*k",
    "min(x*z, abs(atan2(y, z + 2))^1.5 - k) + max(x, y)",
]
"""All operations of the others, in other formulas: rays may meet rare ones by kernels that are compiled then."""
FIELDS = ["x^2 + y^2 + z^2 - k", "sin(9*x)*cos(9*y) + sin(9*z) + k*t", "max(x*y*z, abs(atan2(x, y + 2))^2.5 - k)"]


def compilations(tmp_path, field, *sets, mode="solid", renderer="trace"):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.replace("FIELD", field).replace("MODE", mode).replace("RENDERER", renderer))
    before = compiled.count
    pipeline.render(pipeline.load(path, sets=sets), output=tmp_path / "still.png")
    return compiled.count - before


@pytest.mark.parametrize("renderer", ["trace", "march"])
def test_numbers_times_and_formulas_compile_nothing(tmp_path, renderer):
    compilations(tmp_path, FIELDS[0], renderer=renderer)
    assert compilations(tmp_path, FIELDS[0], "define.k=0.3", renderer=renderer) == 0
    for mode in ("solid", "surface"):
        for field in KNOWN:
            compilations(tmp_path, field, mode=mode, renderer=renderer)
        for field in FIELDS:
            assert compilations(tmp_path, field, mode=mode, renderer=renderer) == 0
            assert compilations(tmp_path, field, "outputs.still.time=0.25 s", mode=mode, renderer=renderer) == 0


def test_the_account_counts_what_is_compiled():
    from numba import njit

    before = compiled.count
    njit("float64(float64)")(lambda x: 2.0 * x)
    assert compiled.count == before + 1


TURNING = """\
sceneql: 1
clock: {end: 1 s}
models:
  swing: {motion: {rotation: {about: z, angle: 360 deg*time/(1 s)}}}
objects:
  still: {implicit: {field: "x^2 + y^2 + z^2 - 0.5", bounds: {ball: 1}}}
  growing: {sphere: {radius: 0.1 m + 2 m/s*time}}
  inner: {sphere: {radius: 0.5 m, position: 5 0 0 m, hidden: yes}}
  arm: {union: {of: [inner, {box: {size: 0.1 0.1 0.1 m}}], rotation: swing.rotation}}
outputs: {still_image: {image: {size: 16 9}}}
"""


def test_what_holds_still_is_framed_by_one_look_and_what_moves_by_all_its_places(tmp_path, monkeypatch):
    from sceneql.words.objects.implicit import Implicit

    looks = []
    lower = Implicit.lower
    monkeypatch.setattr(Implicit, "lower", lambda *given: looks.append(given[1]) or lower(*given))
    path = tmp_path / "scene.yaml"
    path.write_text(TURNING)
    moment = next(pipeline.simulate(pipeline.load(path), [0.25]))
    assert moment.bounds(["still"])[1] == pytest.approx(0.5**0.5, abs=2.0 / 32)  # its surface, not its bounds
    assert looks == ["still"]
    assert moment.bounds(["growing"])[1] == pytest.approx(2.1, abs=1e-4)
    low, high = moment.bounds(["arm"])
    assert low[:2] == pytest.approx([-5.5, -5.5], abs=0.3)
    assert high[:2] == pytest.approx([5.5, 5.5], abs=0.3)
