"""Stiff skins: what their explicit forces cost, and a trial of implicit ones.

    python tests/bench/bench_stiff_skins.py                  both, at 10 and 1e5 N/m
    python tests/bench/bench_stiff_skins.py explicit 1e6     steps, rejected ones and time of `auto`, stretch [N/m]
    python tests/bench/bench_stiff_skins.py trial 1e5 10     NumPy: explicit and implicit steps, length of these [ms]

An ellipse of springs in a vortex of 1 m/s, 64^2 cells, 170 vertices, 1 s. The trial is the same flow by Fourier series
and the same splines: RK4 at the bound, and a stiffly stable additive pair of order 2 (Ascher, Ruuth & Spiteri 1997) in
which the tensions T of the n sides are unknowns of each stage, X = X* + a J u, u = G (w + a S E T), T = T0 + k (l/l0 -
1): Newton's method with (l0/k + a^2 E' J G S E) dT = l - l0 - (T - T0) l0/k by conjugate gradients, preconditioned by
a Cholesky factor of that matrix, which is renewed where they become slow. G: one step of viscosity, projected; S and J
spread and read, E has what sides pull at their ends. The stiffness is in no residual times a length, so none blows up.
"""

from __future__ import annotations

import math
import sys
import time
from typing import Any

import numpy as np
from bench_skins import ELLIPSE, WAVES, Balloon
from scipy.fft import fft2, ifft2
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_matrix

N, SIDE, MU, END = 64, 3.0, 0.1, 1.0
H = SIDE / N
WAVE = 2.0 * np.pi * np.fft.fftfreq(N)
KX, KY = np.meshgrid(WAVE, WAVE, indexing="ij")
LAPLACE = (2.0 * np.cos(KX) + 2.0 * np.cos(KY) - 4.0) / H**2
INVERSE = np.where(LAPLACE == 0.0, 0.0, 1.0 / np.where(LAPLACE == 0.0, 1.0, LAPLACE))
BACK = ((1.0 - np.exp(-1j * KX)) / H, (1.0 - np.exp(-1j * KY)) / H)
AHEAD = ((np.exp(1j * KX) - 1.0) / H, (np.exp(1j * KY) - 1.0) / H)
GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
SLOW = 8
"""Iterations of conjugate gradients from which on the preconditioner is renewed."""


def explicit(stretch: str) -> None:
    """The scene by `auto`."""
    wave = "cos(2*pi*x/3)*cos(2*pi*y/3)*0.477464829275686"
    made = Balloon.of(
        f"clock: {{end: {END} s, fps: 1}}\nmodels:\n  air: {{flow: {{size: 3 3 m, cell: 3/64 m, density: 1 kg/m^3, "
        f'viscosity: {MU} Pa*s, initial: {{stream_function: "{wave}"}}, boundary: {WAVES}}}}}\n'
        f"  balloon: {{membrane: {{of: egg, law: {{springs: {{stretch: {stretch} N/m}}}}, spacing: 3 m/64/2}}}}\n"
        "forces: [{immersion: {on: [balloon], in: air}}]\n"
        f'objects: {{egg: {{implicit: {{field: "{ELLIPSE}", bounds: {{ball: 1}}, position: 1.53 1.53 0 m}}}}}}\n'
    )
    begun = time.process_time()
    made.run.advance(END)
    done, taken = made.run.march.statistics, time.process_time() - begun
    told = f"{done.steps} steps, {done.rejected} rejected, {taken:.2f} s, deformation {made.read('deformation'):.4f}"
    print(f"auto at {stretch} N/m: {told}", flush=True)


def splines(f: Any, cubic: bool) -> Any:
    """Weights (4 or 3, n) of faces around places at f from 0 to 1."""
    if not cubic:
        f = f - 0.5
        return np.stack([0.5 * (0.5 - f) ** 2, 0.75 - f * f, 0.5 * (0.5 + f) ** 2])
    g = 1.0 - f
    rows = (g**3, 3.0 * f**3 - 6.0 * f**2 + 4.0, 3.0 * g**3 - 6.0 * g**2 + 4.0, f**3)
    return np.stack(rows) / 6.0


class Ring:
    """Skin and flow of the trial."""

    def __init__(self, stretch: float) -> None:
        fine = np.arange(20_000) * 2.0 * np.pi / 20_000
        line = np.column_stack([0.75 * np.cos(fine), 0.5 * np.sin(fine)])
        ends = np.append(0.0, np.cumsum(np.hypot(*(np.roll(line, -1, 0) - line).T)))
        count = 170
        q = np.interp(np.arange(count) / count * ends[-1], ends, np.append(fine, 2.0 * np.pi))
        self.x = np.column_stack([0.75 * np.cos(q), 0.5 * np.sin(q)]) + 1.53
        self.rest, self.stretch = np.hypot(*self.sides(self.x).T), stretch
        wave = np.cos(2.0 * np.pi * np.arange(N) / N)
        psi = SIDE / (2.0 * np.pi) * wave[:, None] * wave
        self.u = np.stack([np.roll(psi, -1, 1) - psi, psi - np.roll(psi, -1, 0)]) / H
        self.tension, self.factor, self.area = np.zeros(count), None, self.inside(self.x)
        self.solves = self.factors = 0

    @staticmethod
    def sides(x: Any) -> Any:
        """(n, 2) from each vertex to the next."""
        return np.roll(x, -1, 0) - x

    @staticmethod
    def inside(x: Any) -> float:
        """The area."""
        return 0.5 * float((x[:, 0] * np.roll(x[:, 1], -1) - np.roll(x[:, 0], -1) * x[:, 1]).sum())

    def kept(self, x: Any) -> Any:
        """Vertices moved to the area of the start."""
        for _ in range(3):
            d = 0.5 * (np.roll(x, -1, 0) - np.roll(x, 1, 0))
            normal = np.column_stack([d[:, 1], -d[:, 0]])
            x = x + (self.area - self.inside(x)) / (normal**2).sum() * normal
        return x

    def around(self, x: Any) -> Any:
        """What reads each component at vertices."""
        cell = np.floor(x / H).astype(int)
        f, rows = x / H - cell, []
        for component in range(2):
            wx, wy = splines(f[:, 0], component == 0), splines(f[:, 1], component == 1)
            i = (cell[:, 0] - 1 + np.arange(len(wx))[:, None]) % N
            j = (cell[:, 1] - 1 + np.arange(len(wy))[:, None]) % N
            places = i[:, None] * N + j[None]
            which = np.broadcast_to(np.arange(len(x)), places.shape)
            weights = (wx[:, None] * wy[None]).ravel()
            rows.append(csr_matrix((weights, (which.ravel(), places.ravel())), shape=(len(x), N * N)))
        return rows

    def read(self, rows: Any, u: Any) -> Any:
        """Velocities (n, 2) of vertices."""
        return np.column_stack([rows[k] @ u[k].ravel() for k in range(2)])

    def spread(self, rows: Any, force: Any) -> Any:
        """Accelerations of the fluid by forces (n, 2)."""
        return np.stack([(rows[k].T @ force[:, k]).reshape(N, N) for k in range(2)]) / H**2

    def fluid(self, u: Any, a: float) -> Any:
        """G: viscosity for a time a, and no divergence; also of many at once."""
        self.solves += 1
        modes = fft2(u, axes=(-2, -1))
        p = (AHEAD[0] * modes[..., 0, :, :] + AHEAD[1] * modes[..., 1, :, :]) * INVERSE
        left = modes - np.stack([BACK[0] * p, BACK[1] * p], axis=-3)
        return ifft2(left / (1.0 - a * MU * LAPLACE), axes=(-2, -1)).real

    def advection(self, u: Any) -> Any:
        """By central differences."""

        def at(q: Any, way: int, axis: int) -> Any:
            return np.roll(q, way, axis)

        x, y = 0.5 * (u[0] + at(u[0], -1, 0)), 0.5 * (u[1] + at(u[1], -1, 1))
        both = 0.25 * (u[0] + at(u[0], 1, 1)) * (u[1] + at(u[1], 1, 0))
        return -np.stack(
            [x**2 - at(x**2, 1, 0) + at(both, -1, 1) - both, y**2 - at(y**2, 1, 1) + at(both, -1, 0) - both]
        ) / H  # fmt: skip

    def runge_kutta(self, h: float) -> None:
        """A step of RK4."""

        def rate(u: Any, x: Any) -> Any:
            rows, d = self.around(x), self.sides(x)
            length = np.hypot(*d.T)
            pull = (self.stretch * (length / self.rest - 1.0) / length)[:, None] * d
            thick = ifft2(MU * LAPLACE * fft2(u)).real
            force = self.spread(rows, pull - np.roll(pull, 1, 0))
            return self.fluid(self.advection(u) + thick + force, 0.0), self.read(rows, u)

        k1 = rate(self.u, self.x)
        k2 = rate(self.u + 0.5 * h * k1[0], self.x + 0.5 * h * k1[1])
        k3 = rate(self.u + 0.5 * h * k2[0], self.x + 0.5 * h * k2[1])
        k4 = rate(self.u + h * k3[0], self.x + h * k3[1])
        u, x = ((a + 2.0 * b + 2.0 * c + d) * h / 6.0 for a, b, c, d in zip(k1, k2, k3, k4, strict=True))
        self.u, self.x = self.u + u, self.kept(self.x + x)

    def stage(self, w: Any, start: Any, a: float, x: Any) -> Any:
        """Velocities and places of an implicit stage."""
        soft = self.rest / self.stretch
        for turn in range(40):
            rows, d = self.around(x), self.sides(x)
            d /= np.hypot(*d.T)[:, None]

            def answer(tension: Any, more: Any = 0.0, rows: Any = rows, d: Any = d) -> Any:
                pull = tension[:, None] * d
                return self.fluid(more + a * self.spread(rows, pull - np.roll(pull, 1, 0)), a)

            def shortened(tension: Any, rows: Any = rows, d: Any = d, answer: Any = answer) -> Any:
                return soft * tension - a * (self.sides(self.read(rows, answer(tension))) * d).sum(1)

            u = answer(self.tension, w)
            new = start + a * self.read(rows, u)
            left = np.hypot(*self.sides(new).T) - self.rest - soft * self.tension
            if turn > 0 and max(np.abs(new - x).max(), np.abs(left).max()) < 1e-4 * H:
                return u, new
            if self.factor is None:
                self.factor, self.factors = cho_factor(self.matrix(rows, d, a) + np.diag(soft)), self.factors + 1
            change, target = np.zeros_like(left), 0.03 * np.linalg.norm(left)
            z = p = cho_solve(self.factor, left)
            now, count = left @ z, 0
            while np.linalg.norm(left) > target and count < 40:
                q = shortened(p)
                change, left = change + now / (p @ q) * p, left - now / (p @ q) * q
                z = cho_solve(self.factor, left)
                before, now, count = now, left @ z, count + 1
                p = z + now / before * p
            if count > SLOW:
                self.factor = None
            self.tension = self.tension + change
            x = new + a * self.read(rows, answer(change))
        raise ArithmeticError("Newton's method does not end")

    def matrix(self, rows: Any, d: Any, a: float) -> Any:
        """a^2 E' J G S E."""
        n = len(d)
        pulls = np.stack([np.diag(d[:, k]) for k in range(2)], axis=-1)
        pulls -= np.roll(pulls, 1, axis=1)  # (side, vertex, 2)
        spread = np.stack([(pulls[..., k] @ rows[k]).reshape(n, N, N) for k in range(2)], axis=1) / H**2
        found = self.fluid(spread, a)
        self.solves += n - 1
        parts = sum(spread[:, k].reshape(n, -1) @ found[:, k].reshape(n, -1).T for k in range(2))
        return a * a * H**2 * parts

    def implicit(self, h: float) -> None:
        """A step of the additive pair."""
        a, before = GAMMA * h, 1.0 - 0.5 / GAMMA
        first = self.advection(self.u)
        w = self.fluid(self.u + a * first, 0.0)
        u, x = self.stage(w, self.x, a, self.x + a * self.read(self.around(self.x), self.u))
        rest, moved = (u - w) / a, (x - self.x) / a
        both = before * first + (1.0 - before) * self.advection(u)
        w = self.fluid(self.u + h * both + (h - a) * rest, 0.0)
        self.u, x = self.stage(w, self.x + (h - a) * moved, a, x + (h - a) * moved)
        self.x = self.kept(x)


def trial(stretch: str, step: str) -> None:
    """Both ways, the places of vertices at the end, and the time."""
    ends = []
    bound = min(4e-3, 1e-4 * math.sqrt(1e5 / float(stretch)))
    for way, h in (("runge_kutta", bound), ("implicit", 1e-3 * float(step))):
        ring, begun = Ring(float(stretch)), time.process_time()
        for _ in range(round(END / h)):
            getattr(ring, way)(h)
        taken = time.process_time() - begun
        told = f"{round(END / h)} steps, {ring.solves} solves of the fluid ({ring.factors} matrices), {taken:.2f} s"
        print(f"{way} at {stretch} N/m, NumPy: {told}", flush=True)
        ends.append(ring.x)
    print(f"apart at the end by {np.abs(ends[0] - ends[1]).max():.1e} m")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        {"explicit": explicit, "trial": trial}[sys.argv[1]](*sys.argv[2:])
    else:
        for one in ("10", "1e5"):
            explicit(one)
            trial(one, "10")
