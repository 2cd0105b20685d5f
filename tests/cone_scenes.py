"""Contacts of cubes by hand, for tests of the cone program: no geometry is searched."""

import numpy as np

from cone_programs import cone_program
from sceneql.linear.cones import cone_finish_kernels
from sceneql.linear.cones import cone_layout_kernels as rows

CORNERS = np.array([(x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
GRAVITY = 9.81


def write_body(program, k, mass, inertia, free, guess=None):
    """Mass [kg], inertia (3, 3), velocity without contacts and guess of that with them (6,)."""
    body = program.bodies[k]
    body[rows.AT_MASS] = mass
    body[rows.AT_INERTIA : rows.AT_INERTIA + 9] = np.ravel(inertia)
    body[rows.AT_FREE : rows.AT_FREE + 6] = free
    body[rows.AT_V : rows.AT_V + 6] = free if guess is None else guess


def write_contact(program, k, pair, normal, arms, friction, given, impulse=(0, 0, 0)):
    """Contact k of a pair; arms from the centers of both bodies."""
    contact = program.contacts[k]
    program.pairs[k] = pair
    contact[: rows.AT_VELOCITY] = np.concatenate([normal, *arms, [friction], given, impulse])


def solve(program, contacts):
    """Solve for so many contacts: what the kernel returns."""
    program.ints[rows.CONTACTS] = contacts
    return cone_finish_kernels.solve(program.floats, program.ints)


def velocities(program):
    """(bodies, 6)."""
    return program.bodies[:, rows.AT_V : rows.AT_V + 6].copy()


def impulses(program, contacts):
    """(contacts, 3) in the world."""
    return program.contacts[:contacts, rows.AT_IMPULSE : rows.AT_IMPULSE + 3].copy()


def turn(rotation, spin, step):
    """A rotation after a step of constant spin."""
    angle = np.linalg.norm(spin) * step
    x, y, z = spin * step * (np.sinc(0.5 * angle / np.pi) * 0.5 if angle else 0.5)
    half = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    w = np.cos(0.5 * angle)
    return (np.eye(3) + 2 * w * half + 2 * half @ half) @ rotation


def faces(seed, bodies, count, friction):
    """Cubes at random that touch by squares of four contacts, as faces do: gaps of micrometers to meters a second."""
    draw = np.random.default_rng(seed)
    pairs = [(int(draw.integers(bodies)), int(draw.integers(-1, bodies))) for _ in range(count)]
    program = cone_program(bodies, [(a, b if b != a else -1) for a, b in pairs], 4 * count)
    for k in range(bodies):
        mass = draw.uniform(1, 5)
        write_body(program, k, mass, mass / 6 * np.eye(3), draw.standard_normal(6))
    for c in range(count):
        normal, across, along = np.linalg.qr(draw.standard_normal((3, 3)))[0]
        middles = draw.uniform(-0.3, 0.3, (2, 2))
        for j, (x, y) in enumerate(0.6 * CORNERS):
            arms = [
                h * normal + (u + x) * across + (w + y) * along for (u, w), h in zip(middles, (-0.5, 0.5), strict=True)
            ]
            gap = max(0.0, draw.uniform(-1, 1)) * 10.0 ** draw.uniform(-6, 0)
            write_contact(program, 4 * c + j, c, normal, arms, friction, gap * normal)
    return program


class Stack:
    """Unit cubes on one another on a floor that leans, stepped by an explicit change of places."""

    def __init__(self, masses, friction, slope=0.0, step=5e-3):
        self.masses, self.friction, self.step = np.array(masses, dtype=float), friction, step
        n = len(masses)
        lean = np.arctan(slope)
        self.pull = GRAVITY * np.array([np.sin(lean), 0.0, -np.cos(lean)])
        self.x = np.column_stack([np.zeros((n, 2)), np.arange(n) + 0.5])
        self.rotations = np.array([np.eye(3)] * n)
        self.v = np.zeros((n, 6))
        self.program = cone_program(n, [(k, k - 1) for k in range(n)], 4 * n)
        self.took = []
        self.finishes = []
        self.deepest = 0.0

    def advance(self):
        """One step; the kernel's answer."""
        program, h = self.program, self.step
        for k, mass in enumerate(self.masses):
            inertia = mass / 6 * np.eye(3)
            write_body(program, k, mass, inertia, self.v[k] + h * np.concatenate([self.pull, np.zeros(3)]), self.v[k])
        contacts = 0
        for k in range(len(self.masses)):
            for corner in CORNERS:
                arm = self.rotations[k] @ np.array([*corner, -0.5])
                point = self.x[k] + arm
                if k:
                    normal = self.rotations[k - 1][:, 2]
                    below = point - self.x[k - 1]
                    gap = normal @ below - 0.5
                else:
                    normal, below, gap = np.array([0.0, 0.0, 1.0]), np.zeros(3), point[2]
                self.deepest = max(self.deepest, -gap)
                old = program.contacts[contacts, rows.AT_IMPULSE : rows.AT_IMPULSE + 3].copy()
                given = max(gap, 0.0) / h * normal
                write_contact(program, contacts, k, normal, (arm, below), self.friction, given, old)
                contacts += 1
        answer = solve(program, contacts)
        self.took.append(int(program.ints[rows.ITERATIONS]))
        self.finishes.append(int(program.ints[rows.FINISHES]))
        self.v = velocities(program)
        self.x += h * self.v[:, :3]
        self.rotations = np.array([turn(r, v[3:], h) for r, v in zip(self.rotations, self.v, strict=True)])
        return answer
