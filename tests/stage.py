"""Frames for tests of renderers, made of the closed set by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sceneql.field.tape.builder import TapeBuilder
from sceneql.frame import Implicit, Mesh, Points, Quadric, SeenFrame, Segments, Sun, Surface, View

INF = math.inf
EVERYWHERE = ((-INF,) * 3, (INF,) * 3)
GLOW = Surface(color=(0.0, 0.0, 0.0), specular=0.0, emission=(1.0, 1.0, 1.0))
WHITE = Surface(color=(1.0, 1.0, 1.0), roughness=1.0, specular=0.0)


def local(center: Any, scale: Any = 1.0) -> Any:
    """(3, 4) map of the world to coordinates with ``center`` at zero, divided by ``scale``."""
    matrix = np.eye(3, 4)
    matrix[:, 3] = -np.asarray(center, dtype=float)
    return matrix / np.broadcast_to(scale, 3)[:, None]


def sphere(surface=GLOW, center=(0.0, 0.0, 0.0), radius=1.0):
    return Quadric("sphere", surface, local(center, radius), (1, 1, 1), (0, 0, 0), -1, *EVERYWHERE)


def floor(surface=WHITE, height=0.0):
    return Quadric("floor", surface, local((0, height, 0)), (0, 0, 0), (0, 1, 0), 0, *EVERYWHERE)


def box(surface, center, size):
    half = tuple(side / 2 for side in size)
    return Quadric("box", surface, local(center), (0, 0, 0), (0, 0, 0), -1, tuple(-h for h in half), half)


def cylinder(surface, radius, height):
    low, high = (-INF, -height / 2, -INF), (INF, height / 2, INF)
    return Quadric("cylinder", surface, local((0, 0, 0), (radius, 1, radius)), (1, 0, 1), (0, 0, 0), -1, low, high)


def points(surface, centers, radii):
    return Points("points", surface, np.array(centers, dtype=float), np.array(radii, dtype=float))


def segment(surface, start, end, radius):
    return Segments("segment", surface, np.array([[start, end]], dtype=float), np.array([radius]))


def implicit_sphere(surface, radius=1.0, reach=1.2):
    b = TapeBuilder()
    squares = [b.op("square", axis) for axis in (b.x, b.y, b.z)]
    r = b.op("sqrt", b.op("add", b.op("add", squares[0], squares[1]), squares[2]))
    return Implicit("implicit", surface, b.finish(b.op("sub", r, b.constant(radius))), (-reach,) * 3, (reach,) * 3)


def torus(surface, major, minor):
    """About the z axis."""
    b = TapeBuilder()
    ring = b.op("sqrt", b.op("add", b.op("square", b.x), b.op("square", b.y)))
    off = b.op("square", b.op("sub", ring, b.constant(major)))
    f = b.op("sub", b.op("add", off, b.op("square", b.z)), b.constant(minor**2))
    reach = 1.1 * (major + minor)
    return Implicit("torus", surface, b.finish(f), (-reach, -reach, -2 * minor), (reach, reach, 2 * minor))


def blob(surface, center=(0.0, 0.0, 0.0), seed=0):
    """27 Wyvill kernels on a disturbed lattice, and its box."""
    random = np.random.default_rng(seed)
    lattice = np.stack(np.meshgrid(*[(-0.3, 0.0, 0.3)] * 3), axis=-1).reshape(-1, 3)
    places = lattice + random.normal(size=(27, 3)) * 0.02 + np.array(center)
    parts = np.zeros((27, 8))
    parts[:, :3] = parts[:, 3:6] = places
    parts[:, 6], parts[:, 7] = 0.35, 1.0
    b = TapeBuilder()
    f = b.op("sub", b.constant(0.3), b.density(parts, b.x, b.y, b.z))
    low, high = tuple(places.min(axis=0) - 0.35), tuple(places.max(axis=0) + 0.35)
    return Implicit("blob", surface, b.finish(f), low, high)


def round_mesh(surface, radius=1.0, steps=48):
    """A sphere of triangles with normals."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, steps + 1), np.linspace(0, 2 * np.pi, 2 * steps + 1), indexing="ij")
    normals = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), -np.sin(theta) * np.sin(phi)], axis=-1)
    normals = normals.reshape(-1, 3)
    row = 2 * steps + 1
    corner = (np.arange(steps)[:, None] * row + np.arange(2 * steps)).ravel()
    quads = np.stack([corner, corner + row, corner + row + 1, corner, corner + row + 1, corner + 1], axis=1)
    return Mesh("mesh", surface, radius * normals, quads.reshape(-1, 3).astype(np.int32), normals)


def view(eye=(0.0, 0.0, 5.0), target=(0.0, 0.0, 0.0), size=(96, 96), half_height=1.5, orthographic=True, up=(0, 1, 0)):
    back = np.array(eye, dtype=float) - np.array(target, dtype=float)
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    return View(tuple(eye), np.array([right, np.cross(back, right), back]), size, half_height, orthographic)


def frame(*shapes, lights=(), seen=None):
    return SeenFrame(0, 0.0, tuple(shapes), tuple(lights), seen or view())


def sun(direction, irradiance=(1.0, 1.0, 1.0), angle=0.0):
    x, y, z = direction
    length = math.sqrt(x * x + y * y + z * z)
    return Sun((x / length, y / length, z / length), irradiance, angle)
