"""Ties, stops, motors and friction of joints in the cone program: against an independent solver, and their law."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from cone_programs import cone_program
from cone_scenes import GRAVITY, solve, velocities, write_body, write_contact
from sceneql.linear.cones import cone_finish_kernels as cones
from sceneql.linear.cones import cone_layout_kernels as layout
from sceneql.linear.cones.cone_layout_kernels import ROW_GIVEN, ROW_HIGH, ROW_J, ROW_LOW, ROW_S, ROW_X

NONE = np.inf
HERE = np.zeros(3)
UP = np.array([0.0, 0.0, 1.0])


def write_row(program, k, pair, jacobian, low, high, given):
    """Row k of a pair: its derivative by the velocities of both bodies (12,), bounds, what is added."""
    program.row_pairs[k] = pair
    program.rows[k, ROW_J : ROW_J + 12] = jacobian
    program.rows[k, [ROW_LOW, ROW_HIGH, ROW_GIVEN, ROW_X]] = low, high, given, 0.0


def draw_bodies(program, bodies, draw, ratio):
    for k in range(bodies):
        axes = np.linalg.qr(draw.standard_normal((3, 3)))[0]
        mass = ratio ** draw.random()
        write_body(program, k, mass, mass * axes @ np.diag([0.5, 0.7, 0.9]) @ axes.T, draw.standard_normal(6))


def draw_rows(program, pairs, rows, draw, ratio=1.0, contacts=0):
    """Ties, stops and friction at random between the pairs from number ``contacts`` on."""
    for k in range(rows):
        pair = contacts + int(draw.integers(len(pairs) - contacts))
        jacobian = draw.standard_normal(12)
        if draw.random() < 0.3:
            jacobian[[0, 1, 2, 6, 7, 8]] = 0.0
        size = np.sqrt(ratio) * draw.random()
        low, high = [(-NONE, NONE), (0.0, NONE), (-size, size), (-size, 2 * size)][int(draw.integers(4))]
        write_row(program, k, pair, jacobian, low, high, draw.uniform(-1, 1))


def whole(program, bodies):
    """Masses (6n, 6n), the rows' derivative (rows, 6n), velocities without impulses (6n,)."""
    mass = np.zeros((6 * bodies, 6 * bodies))
    for k in range(bodies):
        body = program.bodies[k]
        mass[6 * k : 6 * k + 3, 6 * k : 6 * k + 3] = body[0] * np.eye(3)
        inertia = body[layout.AT_INERTIA : layout.AT_INERTIA + 9].reshape(3, 3)
        mass[6 * k + 3 : 6 * k + 6, 6 * k + 3 : 6 * k + 6] = inertia
    jacobian = np.zeros((len(program.rows), 6 * bodies))
    for k, row in enumerate(program.rows):
        at = layout.HEAD + layout.PAIR * program.row_pairs[k]
        for side in range(2):
            body = program.ints[at + side]
            if body >= 0:
                jacobian[k, 6 * body : 6 * body + 6] = row[6 * side : 6 * side + 6]
    return mass, jacobian, program.bodies[:, layout.AT_FREE : layout.AT_FREE + 6].ravel()


@pytest.mark.parametrize("ratio", [1.0, 1e3, 1e6])
@pytest.mark.parametrize("tries", [0, 4])
def test_velocities_are_those_of_bounded_least_squares(ratio, tries):
    """Impulses x in their bounds minimize x^T J M^-1 J^T x / 2 + x^T (J v + given): by scipy's active sets."""
    for seed in range(30):
        draw = np.random.default_rng(seed)
        bodies = int(draw.integers(2, 6))
        pairs = [(k, j) for k in range(bodies) for j in range(-1, k)]
        rows = int(draw.integers(1, 5 * bodies))
        program = cone_program(bodies, pairs, 0, rows)
        draw_bodies(program, bodies, draw, ratio)
        draw_rows(program, pairs, rows, draw, ratio)
        program.ints[layout.TRIES] = tries
        assert solve(program, 0) == cones.SOLVED
        assert program.ints[layout.ITERATIONS] <= 20
        mass, jacobian, free = whole(program, bodies)
        root = np.linalg.cholesky(np.linalg.inv(mass))
        left = root.T @ jacobian.T
        aim = -np.linalg.lstsq(left.T, jacobian @ free + program.rows[:, ROW_GIVEN], rcond=None)[0]
        low, high = program.rows[:, ROW_LOW], program.rows[:, ROW_HIGH]
        known = lsq_linear(left, aim, (low, high), method="bvls", tol=1e-15, max_iter=1000).x
        found = velocities(program).ravel()
        np.testing.assert_allclose(found, free + np.linalg.solve(mass, jacobian.T @ known), rtol=0, atol=1e-7)


def test_a_chain_on_the_floor_whose_links_are_tied_twice_rests():
    """Ten links, each tied to the next at both its ends' points, the last 1e6 times as heavy, on two contacts each."""
    count = 10
    pairs = [(k, -1) for k in range(count)] + [(k + 1, k) for k in range(count - 1)]
    program = cone_program(count, pairs, 2 * count, 6 * (count - 1))
    for k in range(count):
        mass = 1e6 if k == count - 1 else 1.0
        write_body(program, k, mass, mass * np.eye(3) / 12, [0, 0, -GRAVITY * 5e-3, 0, 0, 0], np.zeros(6))
        for side in range(2):
            arm = np.array([side - 0.5, 0.0, -0.1])
            write_contact(program, 2 * k + side, k, UP, (arm, HERE), 0.5, HERE)
    for k in range(count - 1):
        for j in range(6):
            direction = np.eye(3)[j % 3]
            arms = np.array([-0.5, 0.0, 0.0]), np.array([0.5, 0.0, 0.0])
            jacobian = [direction, np.cross(arms[0], direction), -direction, -np.cross(arms[1], direction)]
            write_row(program, 6 * k + j, count + k, np.concatenate(jacobian), -NONE, NONE, 0.0)
    for tries in (0, 4):
        program.ints[layout.TRIES] = tries
        assert solve(program, 2 * count) == cones.SOLVED
        assert np.abs(velocities(program)).max() <= 1e-14
        assert program.ints[layout.ITERATIONS] <= 20


@pytest.mark.parametrize("ratio", [1.0, 1e6])
def test_contacts_and_bounded_rows_obey_their_laws_together(ratio):
    """Contacts with friction beside ties, stops and motors: momentum, Coulomb's law and each row's own, recomputed."""
    solved = 0
    for seed in range(40):
        draw = np.random.default_rng(seed)
        bodies, contacts, rows = 6, 8, 8
        pairs = [(int(k), int(draw.integers(-1, k))) for k in draw.integers(0, bodies, contacts)]
        pairs += [(k, j) for k in range(bodies) for j in range(-1, k)]
        program = cone_program(bodies, pairs, contacts, rows)
        draw_bodies(program, bodies, draw, ratio)
        draw_rows(program, pairs, rows, draw, ratio, contacts)
        for c in range(contacts):
            normal = draw.standard_normal(3)
            normal /= np.linalg.norm(normal)
            write_contact(program, c, c, normal, 0.5 * draw.uniform(-1, 1, (2, 3)), 0.2, normal * draw.random())
        if solve(program, contacts) != cones.SOLVED:
            continue
        solved += 1
        found = velocities(program).ravel()
        mass, jacobian, free = whole(program, bodies)
        x, s = program.rows[:, ROW_X], program.rows[:, ROW_S]
        left = mass @ (found - free) - jacobian.T @ x
        np.testing.assert_allclose(s, jacobian @ found + program.rows[:, ROW_GIVEN], atol=1e-11)
        size = np.abs(mass @ found) + np.abs(mass @ free) + np.abs(jacobian.T) @ np.abs(x)
        for c in range(contacts):
            contact, force = program.contacts[c], program.contacts[c, layout.AT_IMPULSE : layout.AT_IMPULSE + 3]
            for side, sign in ((0, 1.0), (1, -1.0)):
                body, arm = pairs[c][side], contact[layout.AT_ARM_A + 3 * side :][:3]
                if body >= 0:
                    left[6 * body : 6 * body + 6] -= sign * np.concatenate([force, np.cross(arm, force)])
                    size[6 * body : 6 * body + 6] += np.abs(force).max()
            u, normal = contact[layout.AT_VELOCITY : layout.AT_VELOCITY + 3], contact[:3]
            push = force @ normal
            slip, rub = u - u @ normal * normal, force - push * normal
            strength = 1e-10 * (np.abs(program.contacts[:, layout.AT_IMPULSE :][:, :3]).max() + 1e-30)
            assert u @ normal >= -1e-9
            assert min(abs(u @ normal), abs(push) / strength * 1e-9) <= 1e-9
            assert np.linalg.norm(rub) <= 0.2 * push + strength
            assert np.linalg.norm(np.linalg.norm(slip) * rub + 0.2 * push * slip) <= strength * (
                1 + np.abs(found).max()
            )
        assert np.abs(left / size.reshape(-1, 6).max(axis=1).repeat(6)).max() <= 1e-10
        low, high = program.rows[:, ROW_LOW], program.rows[:, ROW_HIGH]
        assert ((x >= low - 1e-12) & (x <= high + 1e-12)).all()
        assert (np.abs(s[(x > low) & (x < high)]) <= 1e-9).all()
        assert (s[(x == low) & np.isfinite(low)] >= -1e-9).all()
        assert (s[(x == high) & np.isfinite(high)] <= 1e-9).all()
    assert solved >= 38


def test_a_row_with_one_bound_for_both_has_that_impulse():
    program = cone_program(1, [(0, -1)], 0, 2)
    write_body(program, 0, 2.0, np.eye(3), np.zeros(6))
    write_row(program, 0, 0, [1.0, *(11 * [0.0])], 3.0, 3.0, 0.0)
    write_row(program, 1, 0, 12 * [0.0], -NONE, NONE, 1.0)  # which moves nothing
    assert solve(program, 0) == cones.SOLVED
    np.testing.assert_allclose(velocities(program)[0], [1.5, 0, 0, 0, 0, 0], atol=1e-15)


def test_ties_that_contradict_each_other_are_told():
    program = cone_program(1, [(0, -1)], 0, 2)
    write_body(program, 0, 2.0, np.eye(3), np.zeros(6))
    for k, given in enumerate((0.5, -0.5)):
        write_row(program, k, 0, [1.0, *(11 * [0.0])], -NONE, NONE, given)
    assert solve(program, 0) == cones.LOOSE
    assert np.abs(velocities(program)).max() <= 1e-6
