"""Fields by elements for tests: a model at its start, and the error of its field."""

from __future__ import annotations

import math

import numpy as np

from sceneql.pipeline import load
from sceneql.run.run import IslandRun


class Heat:
    """A diffusion model by elements, with fields of the script."""

    def __init__(self, folder, solver="auto", end=0.1, objects="", **fields):
        fields = {"of": "number", "method": "elements", "coefficient": "1", **fields}
        lines = "\n".join(f"      {key}: {value}" for key, value in fields.items())
        path = folder / "scene.yaml"
        head = f"clock: {{end: {end} s, fps: 10}}\nobjects: {{{objects}}}\n"
        path.write_text(
            f"{head}models:\n  heat:\n    diffusion:\n{lines}\nsolvers: {{main: {solver}}}\n", encoding="utf-8"
        )
        graph = load(path, pruned=False)
        self.model = graph.tasks["heat"].kind
        self.run = IslandRun(graph, graph.islands[0])
        self.run.advance(0.0)

    @property
    def mesh(self):
        return self.model._solved.mesh

    def at(self, time):
        self.run.advance(time)
        return self

    def read(self, output):
        return self.model.read(output, self.run.state("heat"))

    def start_with(self, exact):
        """Start with values (k,) of places (k, 3), other than the script's."""
        y = self.run.march._y1
        y[: self.mesh.count] = exact(self.mesh.places)
        self.run.march._started = False
        return self

    def error(self, exact):
        """Root mean square over the volume from values (k,) of places (k, 3)."""
        places, values, weights = self.model.samples(self.run.state("heat"))
        return math.sqrt(np.average((values - exact(places)) ** 2, weights=weights))
