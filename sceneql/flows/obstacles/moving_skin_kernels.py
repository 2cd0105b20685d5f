# mypy: ignore-errors
"""No-slip walls of solids that move, as kernels: the ties of no_slip.py, face by face, for each new place of them."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout
from sceneql.flows.advection_kernels import sides
from sceneql.flows.obstacles.cut_kernels import nearest, place, side, wall_velocity
from sceneql.flows.obstacles.moving_layout import (
    CENTERS,
    DEPTHS,
    DRAW,
    FIXED,
    FLOW,
    LEVELS,
    NORMALS,
    NUMBERS,
    PARTS,
    SCALES,
    SPACING,
    TIES,
)
from sceneql.flows.obstacles.no_slip_numbers import BESIDE, FARTHEST, HALVINGS, NEAREST
from sceneql.system.signatures_kernels import A, F, I, N


@lean_inlined
def wall_at(floats, ints, axes, component, x, y, z):
    """A component of the velocity of the wall nearest to a point, at its foot there."""
    d, a, b, c, number = nearest(floats, ints, axes, x, y, z)
    u, v, w = wall_velocity(floats, ints, number, x - d * a, y - d * b, z - d * c)
    return side(u, v, w, component)


@lean(F(A, I, N, N, F, F, F, F), inner=True)
def share(floats, ints, axes, axis, x, y, z, way):
    """How far the wall is from a point along an axis, in cells of ``way`` times their side; drawn on where it is
    beyond the next middle."""
    long = way * floats[ints[NUMBERS] + SPACING + axis]
    p, q, r = long if axis == 0 else 0.0, long if axis == 1 else 0.0, long if axis == 2 else 0.0
    low, high = 0.0, 1.0
    first, last = nearest(floats, ints, axes, x, y, z)[0], nearest(floats, ints, axes, x + p, y + q, z + r)[0]
    if last <= 0.0:
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            there = nearest(floats, ints, axes, x + middle * p, y + middle * q, z + middle * r)[0]
            if there > 0.0:
                low, first = middle, there
            else:
                high, last = middle, there
    found = low + (high - low) * first / (first - last) if first > last else 1.0
    return min(max(found, NEAREST), FARTHEST)


@lean_inlined
def is_free(f, least, floats, ints):
    """Whether viscosity acts on a face at its middle."""
    return floats[ints[PARTS] + f] > 0.0 and floats[ints[LEVELS] + f] > least


@lean(types.void(A, I, N), inner=True)
def scales(floats, ints, component):
    """Velocities in the middles of faces by those of their open parts."""
    flow = ints[ints[FLOW] :]
    axes = flow[layout.AXES]
    nx, ny, nz = sides(component, flow)
    spacing = ints[NUMBERS] + SPACING
    least = BESIDE * min(floats[spacing], floats[spacing + 1], floats[spacing + 2] if axes == 3 else floats[spacing])
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                f = flow[layout.STARTS + component] + i + nx * (j + ny * k)
                floats[ints[SCALES] + f], floats[ints[FIXED] + f] = 1.0, 0.0
                part = floats[ints[PARTS] + f]
                if part < 1.0 and is_free(f, least, floats, ints):
                    scale = floats[ints[LEVELS] + f] / floats[ints[DEPTHS] + f]
                    x, y, z = place(floats, ints, axes, component, i, j, k)
                    a, b, c = floats[ints[CENTERS] + f], floats[ints[CENTERS + 1] + f], floats[ints[CENTERS + 2] + f]
                    floats[ints[SCALES] + f] = scale
                    floats[ints[FIXED] + f] = wall_at(floats, ints, axes, component, x, y, z) - scale * wall_at(
                        floats, ints, axes, component, a, b, c
                    )


@lean_inlined
def opened_wall(f, floats, ints, component):
    """The wall's velocity beside the middle of what is open of a face."""
    x, y, z = (
        floats[ints[CENTERS] + f],
        floats[ints[CENTERS + 1] + f],
        floats[ints[CENTERS + 2] + f],
    )
    return wall_at(floats, ints, ints[ints[FLOW] + layout.AXES], component, x, y, z)


@lean(types.void(A, I, N, F), inner=True)
def draw(floats, ints, component, least):
    """Tie velocities beside the wall to those of the next faces off it."""
    flow = ints[ints[FLOW] :]
    axes, start = flow[layout.AXES], flow[layout.STARTS + component]
    nx, ny, nz = sides(component, flow)
    friction, gains = floats[flow[layout.FRICTION] + start :], floats[flow[layout.GAINS] + start :]
    depth = floats[ints[DEPTHS] + start :]
    strength = 2.0 * floats[ints[NUMBERS] + DRAW]
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                f = i + nx * (j + ny * k)
                if floats[ints[PARTS] + start + f] == 0.0 or is_free(start + f, least, floats, ints):
                    continue
                wall = opened_wall(start + f, floats, ints, component)
                friction[f] += strength
                gains[f] += strength * wall
                tried = 0
                for _ in range(axes):
                    axis, best = 0, -1.0
                    for one in range(axes):
                        lean_ = abs(floats[ints[NORMALS + one] + start + f])
                        if not tried & (1 << one) and lean_ > best:
                            axis, best = one, lean_
                    tried |= 1 << axis
                    slope = floats[ints[NORMALS + axis] + start + f]
                    if slope == 0.0:
                        continue
                    stride, count = (1 if axis == 0 else (nx if axis == 1 else nx * ny)), side(nx, ny, nz, axis)
                    at = side(i, j, k, axis)
                    if slope < 0.0:
                        other = f - stride if at > 0 else f + (count - 1) * stride
                    else:
                        other = f + stride if at < count - 1 else f - (count - 1) * stride
                    held = f if slope < 0.0 else other
                    if floats[ints[TIES + axis] + start + held] == 0.0:
                        continue
                    if not is_free(start + other, least, floats, ints):
                        continue
                    ratio = min(depth[f] / depth[other], 1.0)
                    beyond = opened_wall(start + other, floats, ints, component)
                    floats[flow[layout.VISCOUS + axis] + start + held] += strength * ratio
                    friction[f] -= strength * ratio
                    gains[f] -= strength * ratio * beyond
                    friction[other] += strength * ratio * (ratio - 1.0)
                    gains[other] += strength * ratio * (ratio * beyond - wall)
                    break


@lean(types.void(A, I, N), inner=True)
def tie(floats, ints, component):
    """Write the ties, the friction and what walls add of a component's faces, whose scales are known."""
    flow = ints[ints[FLOW] :]
    axes, start = flow[layout.AXES], flow[layout.STARTS + component]
    nx, ny, nz = sides(component, flow)
    spacing = ints[NUMBERS] + SPACING
    least = BESIDE * min(floats[spacing], floats[spacing + 1], floats[spacing + 2] if axes == 3 else floats[spacing])
    friction, gains = floats[flow[layout.FRICTION] + start :], floats[flow[layout.GAINS] + start :]
    scale, fixed = floats[ints[SCALES] + start :], floats[ints[FIXED] + start :]
    for f in range(nx * ny * nz):
        friction[f] = gains[f] = 0.0
    for axis in range(axes):
        base, own = floats[ints[TIES + axis] + start :], floats[flow[layout.VISCOUS + axis] + start :]
        stride, count = (1 if axis == 0 else (nx if axis == 1 else nx * ny)), side(nx, ny, nz, axis)
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    f, at = i + nx * (j + ny * k), side(i, j, k, axis)
                    own[f] = 0.0
                    if not is_free(start + f, least, floats, ints):
                        continue
                    for high in range(2):
                        if high == 0:
                            other = f - stride if at > 0 else f + (count - 1) * stride
                        else:
                            other = f + stride if at < count - 1 else f - (count - 1) * stride
                        strength = base[other] if high == 1 else base[f]
                        if strength == 0.0:
                            continue
                        if is_free(start + other, least, floats, ints):
                            friction[f] += scale[f] * (scale[f] - scale[other]) * strength
                            gains[f] += scale[f] * (fixed[other] - fixed[f]) * strength
                            if high == 0:
                                own[f] = scale[f] * scale[other] * strength
                            continue
                        x, y, z = place(floats, ints, axes, component, i, j, k)
                        way = 2.0 * high - 1.0
                        far = share(floats, ints, axes, axis, x, y, z, way)
                        move = way * far * floats[spacing + axis]
                        x, y, z = (
                            x + (move if axis == 0 else 0.0),
                            y + (move if axis == 1 else 0.0),
                            z + (move if axis == 2 else 0.0),
                        )
                        strength *= scale[f] / far
                        friction[f] += scale[f] * strength
                        gains[f] += strength * (wall_at(floats, ints, axes, component, x, y, z) - fixed[f])
    draw(floats, ints, component, least)
