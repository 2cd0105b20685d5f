"""A solid that is filled again is not meshed again, and no mesh is that of another."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql.bodies.elements import filled
from sceneql.pipeline import load
from sceneql.run.run import Run

SCENE = """\
clock: {{end: 1 s}}
objects:
  ball: {{sphere: {{radius: {radius} m, position: {at} 0 0 m}}}}
models:
  body: {{elastic: {{of: ball, spacing: {spacing} m, element: {element}, law: {{linear: {{modulus: 1 kPa}}}}{more}}}}}
solvers: {{main: rk4}}
"""
FIRST = {"radius": 0.5, "at": 0, "spacing": 0.25, "element": "p1", "more": ""}


@pytest.fixture
def meshes(tmp_path, monkeypatch):
    """A function of fields: the mesh of such a body, and how many have been made."""
    made, original = [], filled._filled
    monkeypatch.setattr(filled, "_kept", {})
    monkeypatch.setattr(filled, "_filled", lambda *given: made.append(given) or original(*given))

    def mesh(**fields):
        path = tmp_path / "s.yaml"
        path.write_text(SCENE.format(**{**FIRST, **fields}), encoding="utf-8")
        run = Run(load(path, pruned=False))
        run.at(0.0)
        return run.graph.tasks["body"].kind._made.strain.mesh, len(made)

    return mesh


def test_the_same_solid_is_meshed_once_and_may_be_written_into(meshes):
    first, _ = meshes()
    points, cells = first.points.copy(), first.cells.copy()
    first.points[:], first.cells[:] = 7.0, 0
    again, made = meshes(more=", density: 3 g/cm^3")
    assert made == 1
    assert again.points.tobytes() == points.tobytes()
    assert again.cells.tobytes() == cells.tobytes()


@pytest.mark.parametrize(
    "other", [{"radius": 0.6}, {"at": 0.1}, {"spacing": 0.2}, {"element": "p2"}], ids=lambda other: next(iter(other))
)
def test_another_solid_has_a_mesh_of_its_own(meshes, other):
    first, _ = meshes()
    second, made = meshes(**other)
    assert made == 2
    assert len(first.points) != len(second.points) or not np.array_equal(first.points, second.points)
    assert meshes()[1] == 2


def test_few_meshes_are_kept(meshes, monkeypatch):
    monkeypatch.setattr(filled, "KEPT", 1)
    assert [meshes(at=at)[1] for at in (0.0, 0.1, 0.1, 0.0)] == [1, 2, 2, 3]
