"""Radau above the size of full matrices: sparse factors, the complex system by iterations with the real ones."""

from __future__ import annotations

import math

import numpy as np
import pytest

from islands import final, fixed
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.report.explain import explain
from sceneql.run.run import IslandRun
from sceneql.stepping import radau_systems
from sceneql.words.solvers.radau import Radau

COUNT, MASS, STIFFNESS = 142, 0.1, 50.0
"""Masses on a line, both ends held: 420 unknowns in the linear systems."""


def chain(folder, amplitudes, damping=0.0, solver="radau"):
    """The run of a chain whose masses stand off their places by a sum of standing waves {number: amplitude [m]}."""
    wave = {n: math.pi * n / (COUNT - 1) for n in amplitudes}
    off = [sum(a * math.sin(wave[n] * k) for n, a in amplitudes.items()) for k in range(COUNT)]
    masses = ", ".join(f"m{k}: {{position: {k + off[k]!r} 0 0 m}}" for k in range(COUNT))
    ties = ", ".join(f"{{between: [m{k}, m{k + 1}], rest: 1 m}}" for k in range(COUNT - 1))
    path = folder / "scene.yaml"
    path.write_text(
        f"clock: {{end: 10 s}}\nsolvers: {{main: {solver}}}\nmodels:\n"
        f"  chain: {{mass_spring: {{masses: {{{masses}}}, springs: [{ties}], mass: {MASS} kg, "
        f"stiffness: {STIFFNESS} N/m, damping: {damping} N*s/m, pins: [m0, m{COUNT - 1}]}}}}\n",
        encoding="utf-8",
    )
    graph = load(path, pruned=False)
    return graph, IslandRun(graph, graph.islands[0])


def exact(amplitudes, t):
    """Where the masses are (COUNT,) [m]: each wave swings at 2 sqrt(k/m) sin(q/2)."""
    found = np.arange(float(COUNT))
    for n, amplitude in amplitudes.items():
        q = math.pi * n / (COUNT - 1)
        speed = 2.0 * math.sqrt(STIFFNESS / MASS) * math.sin(q / 2)
        found += amplitude * math.cos(speed * t) * np.sin(q * np.arange(COUNT))
    return found


def along(y):
    """Places of the masses on the line."""
    return y[: 3 * COUNT : 3]


def test_its_order_is_five_on_many_unknowns(tmp_path):
    waves = {2: 0.1, 30: 0.01}
    system = chain(tmp_path, waves)[1].march.system
    end = 0.6
    errors = [
        np.abs(along(final(system, fixed(Radau().stepper(), end / n), end)) - exact(waves, end)).max() for n in (8, 16)
    ]
    assert errors[1] < 1e-6
    assert math.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.4)


def test_stiff_modes_of_many_unknowns_die_out_at_once(tmp_path):
    """One step of 1000 s, some 44,000 times the time of the quickest mode: |R(z)| is near 3/|z|."""
    waves = {140: 0.1, 77: 0.05}
    system = chain(tmp_path, waves)[1].march.system
    left = np.abs(along(final(system, fixed(Radau().stepper(), 1000.0), 1000.0)) - np.arange(COUNT)).max()
    assert left < 1e-4


@pytest.mark.parametrize("damping", [0.0, 1e3])
def test_sparse_and_full_factors_give_the_same_run(tmp_path, monkeypatch, damping):
    ends = []
    for full in (0, 1000):
        monkeypatch.setattr(radau_systems, "FULL", full)
        march = chain(tmp_path, {3: 0.2}, damping, "{radau: {tolerance: 1e-9}}")[1].march
        y, _ = march.advance(1.0)
        ends.append(along(y))
        assert march.statistics.steps < 300
    assert ends[0] == pytest.approx(ends[1], abs=1e-7)
    if not damping:
        assert ends[0] == pytest.approx(exact({3: 0.2}, 1.0), abs=1e-6)


def test_auto_goes_stiff_with_many_unknowns(tmp_path):
    """A rope of 450 unknowns and stiff springs falls from level; its shape is that of radau at a tighter tolerance."""
    ends = []
    for solver in ("auto: {tolerance: 1e-4}", "radau: {tolerance: 1e-7}"):
        path = tmp_path / "scene.yaml"
        path.write_text(
            f"clock: {{end: 0.02 s}}\nsolvers: {{main: {{{solver}}}}}\nforces: [gravity]\nmodels:\n"
            "  m: {mass_spring: {rope: {from: 0 0 0 m, to: 3 0 0 m, count: 151}, mass: 1 g, stiffness: 1e8 N/m, "
            "damping: 10 N*s/m, pins: [start]}}\n",
            encoding="utf-8",
        )
        graph = load(path, pruned=False)
        run = IslandRun(graph, graph.islands[0])
        march = run.march
        ends.append(march.advance(0.02)[0][: 3 * 151])
        if solver.startswith("auto"):
            assert [why.partition(":")[0] for _, why in march.choices()] == ["radau"]
            assert march.statistics.steps < 200
    assert ends[0] == pytest.approx(ends[1], abs=1e-5)


def test_explain_says_how_radau_solves_its_systems(tmp_path):
    graph, run = chain(tmp_path, {1: 0.1})
    assert "sparse factorization of 420 unknowns" in str(explain(graph))
    assert "iterations with the same factors" in run.march.prepared_text


def test_growth_does_not_break_the_iterations(tmp_path):
    """Modes that grow, beyond the half-plane that the iterations are made for."""
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\nsolvers: {main: {radau: {tolerance: 1e-8}}}\n"
        "models: {m: {equations: {start: {a: 1}, rate: {a: '(1 + i/100)*a'}, copies: {count: 200}}}}\n",
        encoding="utf-8",
    )
    graph = load(path, pruned=False)
    y, _ = IslandRun(graph, graph.islands[0]).march.advance(1.0)
    assert y == pytest.approx(np.exp(1 + np.arange(200) / 100), rel=1e-6)


def test_a_field_is_marched_by_radau(tmp_path):
    """A cosine on a box of 24 x 24 cells decays by what its cells make of the Laplacian."""
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\nsolvers: {main: {radau: {tolerance: 1e-7}}}\nmodels:\n"
        "  heat: {diffusion: {of: number, coefficient: 1e-2 m^2/s, size: 1 1 m, cell: 1/24 m, "
        'initial: "cos(pi*x)"}}\n',
        encoding="utf-8",
    )
    graph = load(path, pruned=False)
    march: March = IslandRun(graph, graph.islands[0]).march
    start = march.system.y.copy()
    y, _ = march.advance(1.0)
    speed = 1e-2 * (2.0 * 24 * math.sin(math.pi / 48)) ** 2
    assert y[:576] == pytest.approx(start[:576] * math.exp(-speed), abs=1e-7)
