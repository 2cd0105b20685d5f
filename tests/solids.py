"""Solids of elements as scripts make them, with their forces and stiffness, and their rest by Newton's method."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix, eye_array, kron
from scipy.sparse.linalg import splu

import sceneql.system.channels as channels
from sceneql.march.driver import jacobian
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.run.run import IslandRun
from sceneql.system import ModelState
from sceneql.words.solvers.rk4 import Rk4


class Solid:
    """The model `body` of a script, in an island of its own."""

    def __init__(self, folder: Path, fields: str, more: str = "", time: float = 0.0) -> None:
        path = folder / "scene.yaml"
        start = "clock: {end: 1 s}\nsolvers: {main: rk4}\n"
        path.write_text(f"{start}models: {{body: {{elastic: {fields}}}}}\n{more}", encoding="utf-8")
        graph = load(path, pruned=False)
        self.run = IslandRun(graph, graph.islands[0])
        self.march = March(self.run.assembly.finish(jacobian=True), Rk4().stepper(), 1.0)
        self.kind: Any = graph.tasks["body"].kind
        self.bodies: Any = self.run.bodies["body"]
        self.mesh = self.kind.solid.mesh
        self.time = time
        self.count = 3 * self.bodies.count
        self.inertia = kron(self.kind.solid.inertia.matrix, eye_array(3)).tocsr()
        self.masses = self.inertia.sum(axis=1)

    def state(self, places: Any, speeds: Any = None) -> Any:
        """The island's state with nodes at places (n, 3)."""
        y = self.march.system.y.copy()
        y[self.bodies.position_at :][: self.count] = np.ravel(places)
        if speeds is not None:
            y[self.bodies.velocity_at :][: self.count] = np.ravel(speeds)
        return y

    @property
    def places(self) -> Any:
        """(n, 3) at the start."""
        return self.march.system.y[self.bodies.position_at :][: self.count].reshape(-1, 3).copy()

    def forces(self, places: Any, speeds: Any = None) -> Any:
        """(n, 3) on the nodes [N], where nothing holds them."""
        rate = self.march.rate(self.time, self.state(places, speeds))
        return (self.inertia @ rate[self.bodies.velocity_at :][: self.count]).reshape(-1, 3)

    def stiffness(self, places: Any, speeds: Any = None, positive: bool = False, by: str = "position") -> Any:
        """Minus the derivative of the forces by the places or velocities, sparse [N/m]."""
        system, y = self.march.system, self.state(places, speeds)
        values = np.full(system.pattern.room, np.nan)
        self.march.floats[channels.POSITIVE] = float(positive)
        jacobian(system)(self.march._engaged.functions, self.time, y, values, self.march.floats, system.ints)
        self.march.floats[channels.POSITIVE] = 0.0
        n = len(y)
        matrix = coo_matrix((values[: system.pattern.count], (system.pattern.rows, system.pattern.columns)), (n, n))
        at = {"position": self.bodies.position_at, "velocity": self.bodies.velocity_at}[by]
        rows = matrix.tocsr()[self.bodies.velocity_at : self.bodies.velocity_at + self.count]
        found = -rows[:, at : at + self.count]
        return found.tocsr() if self.kind.solid.inertia.consistent else (self.inertia @ found).tocsr()

    def model_state(self, places: Any) -> Any:
        """What outputs are read from."""
        y = self.state(places)
        rate, ints = self.march.rate(self.time, y), self.run.assembly.remembered("body")
        return ModelState(self.time, y, rate, self.march.floats, self.bodies, ints)

    def read(self, output: str, places: Any) -> Any:
        """An output of the model with nodes at places."""
        return self.kind.read(output, self.model_state(places))

    def free(self) -> Any:
        """(3 n,) bool: what no hold holds."""
        return ~np.ravel(self.bodies.skin.held)

    def rest(self, places: Any = None, tolerance: float = 1e-10, most: int = 60) -> tuple[Any, int]:
        """Places where all forces are in balance, by Newton's method, and how many steps it took."""
        places = self.places if places is None else places
        free, scale = self.free(), None
        for k in range(most):
            force = self.forces(places).ravel()[free]
            scale = max(np.abs(force).max(), 1e-300) if scale is None else scale
            matrix = self.stiffness(places).tocsc()[free][:, free]
            step = np.zeros(self.count)
            step[free] = splu(matrix).solve(force)
            places = places + step.reshape(-1, 3)
            if np.abs(step).max() < tolerance * np.ptp(self.mesh.points):
                return places, k + 1
        raise AssertionError("no rest was found")
