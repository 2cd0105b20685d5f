# mypy: ignore-errors
"""Points of a skeleton in blocks of VECTOR in float32: which of them reach a piece of a single ray, or a beam.

``blocks`` (6, columns) has a column for each point, in their order: place (3), square of the reach, row in the tape's
parts; and for each block, and each block of blocks: low (3) and high (3). They are filled up to whole blocks. The
number of points stands in row COUNT of the first column. Several such may stand side by side.
"""

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import below, bits_below, first_bit, load, root
from sceneql.field.packets.packet_kernels import VECTOR
from sceneql.field.roots.density_march_kernels import MORE, F

REACH2, ROW, COUNT = 3, 4, 5
BLOCKS = 6
ROUNDED = 1.0e-5
"""Padding of reaches and boxes, relative to their sizes and to their distances from the origin."""
STEEPEST = 1.0e30
ZERO = F(0.0)


@inlined
def whole(n):
    """n, rounded up to whole blocks."""
    return (n + VECTOR - 1) // VECTOR * VECTOR


@inlined
def inverse_of(d):
    """1/d in float32, or a large number of its sign."""
    return F(1.0 / d) if abs(d) * STEEPEST > 1.0 else (F(STEEPEST) if d >= 0.0 else F(-STEEPEST))


@inlined
def planes(place, inverse, hair):
    """(row of the boxes' planes that a ray meets first along an axis, from 0 on; what to subtract from these, and from
    the planes behind, so that boxes are larger by ``hair``)."""
    return (0, place + hair, place - hair) if inverse > ZERO else (3, place - hair, place + hair)


@inlined
def boxes_met(blocks, at, count, ray, far):
    """Bit mask of those of ``count`` boxes from column ``at`` on, at most VECTOR, that a ray enters before ``far``."""
    (x, x_in, x_out), (y, y_in, y_out), (z, z_in, z_out), ix, iy, iz = ray
    x0, x1 = (load(blocks[x], at) - x_in) * ix, (load(blocks[3 - x], at) - x_out) * ix
    y0, y1 = (load(blocks[1 + y], at) - y_in) * iy, (load(blocks[4 - y], at) - y_out) * iy
    z0, z1 = (load(blocks[2 + z], at) - z_in) * iz, (load(blocks[5 - z], at) - z_out) * iz
    enter, leave = below(x0, y0, y0, x0), below(x1, y1, x1, y1)
    enter, leave = below(enter, z0, z0, enter), below(leave, z1, leave, z1)
    enter, leave = below(enter, ZERO, ZERO, enter), below(leave, far, leave, far)
    return ~bits_below(leave, enter) & ((1 << min(count, VECTOR)) - 1)


@inlined
def points_met(blocks, at, count, x, y, z, dx, dy, dz, far, hair, wide):
    """The same of points that reach a beam so ``wide`` about the ray."""
    ex, ey, ez = load(blocks[0], at) - x, load(blocks[1], at) - y, load(blocks[2], at) - z
    along = ex * dx + ey * dy + ez * dz
    along = below(along, ZERO, ZERO, below(along, far, along, far))
    ex, ey, ez = ex - along * dx, ey - along * dy, ez - along * dz
    off = ex * ex + ey * ey + ez * ez
    reach2 = load(blocks[REACH2], at)
    if wide > ZERO:
        reach = root(reach2) + wide
        reach2 = MORE * (reach * reach)
    return ~bits_below(reach2 + hair * hair, off) & ((1 << min(count, VECTOR)) - 1)


@inlined
def list_on_ray(blocks, base, px, py, pz, ux, uy, uz, length, listed):
    """``list_in_beam`` of a single ray."""
    return list_in_beam(blocks, base, px, py, pz, ux, uy, uz, length, 0.0, listed)


@inlined
def list_in_beam(blocks, base, px, py, pz, ux, uy, uz, length, radius, listed):
    """List the rows of points that reach a beam about a line from a place in a unit direction; returns their number.

    They stand in the order of the rows; some are among them that only nearly reach it. The blocks begin at column
    ``base``.
    """
    n = int(blocks[COUNT, base])
    many = whole(n) // VECTOR
    most = whole(many) // VECTOR
    first, second = base + whole(n), base + whole(n) + whole(many)
    x, y, z, dx, dy, dz, far = F(px), F(py), F(pz), F(ux), F(uy), F(uz), F(length)
    ix, iy, iz = inverse_of(ux), inverse_of(uy), inverse_of(uz)
    hair, wide = F(ROUNDED * (abs(px) + abs(py) + abs(pz) + length)), F(radius * (1.0 + ROUNDED))
    room = hair + wide
    ray = planes(x, ix, room), planes(y, iy, room), planes(z, iz, room), ix, iy, iz
    far = far + hair
    kept = 0
    for group in range(0, most, VECTOR):
        groups = boxes_met(blocks, second + group, most - group, ray, far)
        while groups != 0:
            block = VECTOR * (group + first_bit(groups))
            groups &= groups - 1
            some = boxes_met(blocks, first + block, many - block, ray, far)
            while some != 0:
                at = VECTOR * (block + first_bit(some))
                some &= some - 1
                points = points_met(blocks, base + at, n - at, x, y, z, dx, dy, dz, far, hair, wide)
                while points != 0:
                    listed[kept] = int(blocks[ROW, base + at + first_bit(points)])
                    points &= points - 1
                    kept += 1
    return kept
