"""Cubes thrown into a bin, and how deep boxes are in each other by the axes that separate them, by numpy alone."""

from __future__ import annotations

import numpy as np

SIDE = 0.2
"""Of a cube [m]."""


def half_width(edge):
    """Half of the inner width of the bin [m] of edge^3 cubes."""
    return 0.85 * SIDE * edge


def script(edge, step, end):
    """Edge^3 cubes of 600 kg/m^3 above a floor between four walls, each with a velocity and a spin of its own."""
    width = half_width(edge) + 0.1
    at = f"{1.35 * SIDE} m*({{}} - {(edge - 1) / 2}) + 0.02 m*(random(i, {{}}) - 0.5)"
    place = f'["{at.format(f"mod(i, {edge})", 1)}", "{0.8 * SIDE} m + {1.35 * SIDE} m*floor(i/{edge * edge})", '
    place += f'"{at.format(f"mod(floor(i/{edge}), {edge})", 2)}"]'
    velocity = '["2 m/s*(random(i, 4) - 0.5)", "-2 m/s*random(i, 5)", "2 m/s*(random(i, 6) - 0.5)"]'
    spin = "[" + ", ".join(f'"8 rad/s*(random(i, {k}) - 0.5)"' for k in (7, 8, 9)) + "]"
    return f"""
clock: {{end: {end} s}}
objects:
  cube:
    repeat: {{count: {edge**3}, as: i}}
    box:
      size: {SIDE} {SIDE} {SIDE} m
      position: {place}
      rotation: {{about: y, angle: "40 deg*(random(i, 3) - 0.5)"}}
  floor: {{box: {{size: 6 0.2 6 m, position: 0 -0.1 0 m}}}}
  left: {{box: {{size: 0.2 3 3 m, position: {-width} 1.5 0 m}}}}
  right: {{box: {{size: 0.2 3 3 m, position: {width} 1.5 0 m}}}}
  back: {{box: {{size: 3 3 0.2 m, position: 0 1.5 {-width} m}}}}
  front: {{box: {{size: 3 3 0.2 m, position: 0 1.5 {width} m}}}}
models:
  pile:
    rigid:
      bodies:
        c:
          repeat: {{count: {edge**3}, as: i}}
          of: "cube.{{i}}"
          density: 600 kg/m^3
          velocity: {velocity}
          spin: {spin}
forces: [gravity]
contacts: {{touch: {{collision: {{restitution: 0.1, friction: 0.4, mode: local}}}}}}
solvers: {{main: {{semi_implicit_euler: {{step: {step} ms}}}}}}
"""


def axes(q):
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4)."""
    w, x, y, z = q.T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=1)


def overlap(x, a, half_a, y, b, half_b):
    """Depths (n,) of pairs of boxes [m], negative where they are apart: centers, axes (n, 3, 3), half sides.

    The least over the six normals of faces and the nine products of edges (Gottschalk, Lin & Manocha 1996).
    """
    tried = [m[:, :, k] for m in (a, b) for k in range(3)]
    tried += [np.cross(a[:, :, j], b[:, :, k]) for j in range(3) for k in range(3)]
    best = np.full(len(x), np.inf)
    for axis in tried:
        long = np.linalg.norm(axis, axis=1)
        unit = axis / np.where(long > 1e-9, long, 1.0)[:, None]
        reach = np.abs(np.einsum("nij,ni->nj", a, unit)) @ half_a + np.abs(np.einsum("nij,ni->nj", b, unit)) @ half_b
        depth = reach - np.abs(np.einsum("ni,ni->n", y - x, unit))
        best = np.where(long > 1e-9, np.minimum(best, depth), best)
    return best


def deepest(edge, x, q):
    """How deep any cube is in another or in the bin [m]: places (n, 3) and quaternions (n, 4)."""
    turned, half = axes(q / np.linalg.norm(q, axis=1)[:, None]), np.full(3, SIDE / 2)
    i, j = np.nonzero(np.triu(np.linalg.norm(x[:, None] - x, axis=2) < SIDE * 3**0.5, 1))
    found = [overlap(x[i], turned[i], half, x[j], turned[j], half).max(initial=-np.inf)]
    corners = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]) * SIDE / 2
    points = x[:, None] + np.einsum("nij,kj->nki", turned, corners)
    # The bin is deeper than any pile: its sides are planes.
    found += [-points[..., 1].min(), (np.abs(points[..., (0, 2)]) - half_width(edge)).max()]
    return max(found)
