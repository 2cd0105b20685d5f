"""Flows of scripts on their way, for tests."""

from __future__ import annotations

from sceneql.pipeline import load
from sceneql.run.run import IslandRun

WAVES = "{left: {periodic: yes}, bottom: {periodic: yes}}"
VORTEX = '{velocity: "[-cos(x)*sin(y), sin(x)*cos(y)]"}'


class Air:
    """One flow, alone or with other models, on its way."""

    def __init__(self, folder, solver="{rk4: {step: 5 ms}}", end=0.1, models="", before="", first="", **fields):
        fields = {"size": "1 1 m", "cell": "1/16 m", "density": "1 kg/m^3", "viscosity": "0.05 Pa*s", **fields}
        lines = "\n".join(f"      {key}: {value}" for key, value in fields.items() if value is not None)
        path = folder / "scene.yaml"
        text = f"clock: {{end: {end} s, fps: 10}}\n{before}models:\n{first}  air:\n    flow:\n{lines}\n{models}"
        path.write_text(f"{text}solvers: {{main: {solver}}}\n", encoding="utf-8")
        graph = load(path, pruned=False)
        self.graph, self.tasks, self.end = graph, graph.tasks, end
        self.run = IslandRun(graph, graph.islands[0])

    def at(self, time):
        self.run.advance(time)
        return self

    def read(self, output, model="air"):
        return self.tasks[model].kind.read(output, self.run.state(model))


def waves(folder, cells, solver, end=0.5, **more):
    """Taylor and Green's vortex (1937) in a periodic box of 2 pi."""
    side = 6.283185307179586
    more = {"advection": "central", "viscosity": "0.1 Pa*s", "initial": VORTEX, "boundary": WAVES, **more}
    return Air(folder, solver, end, size=f"{side} {side} m", cell=f"{side}/{cells} m", **more)
