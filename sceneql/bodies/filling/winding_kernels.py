# mypy: ignore-errors
"""How often triangles wind around points: far clusters by moments, near triangles by solid angles.

w(q) = 1/(4 pi) int n.(y - q)/|y - q|^3 dA (Jacobson, Kavan & Sorkine-Hornung 2013) is the potential of dipoles. That of
a cluster is expanded about a point p of it, up to octupoles (Barill et al. 2018, section 3): with u = p - q,
4 pi w = D.u/R^3 - 3 Q(u, u)/R^5 + 15/2 T(u, u, u)/R^7, D = int n dA, Q and T the symmetric traceless parts of
int n (y - p) dA and int n (y - p)(y - p) dA. A term of degree l is at most l r^(l-1)/R^(l+1) of a dipole no farther
than r from p (the gradient of a Legendre polynomial's solid harmonic, by Bernstein and Szegoe), so what is left out is
at most x^3 (4 - 3x)/(1 - x)^2 of area/R^2, x = r/R.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.mesh.box_tree_kernels import FIRST, HELD, NODES, ROWS, SKIP

CENTER, RADIUS, AREA, DIPOLE, QUADRUPOLE, OCTUPOLE, MOMENTS = 0, 3, 4, 5, 8, 14, 24
"""Columns of a cluster: p, r, area; D; Q by xx, yy, zz, xy, xz, yz; T by xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy,
xyz; the last two with the numbers by which the products of u are counted, and those of the sum above."""
WIDEST = (0.4, 0.2, 0.1, 0.05, 0.0)
"""Largest x = r/R of a cluster that is expanded, tried in turn until the bound on the error leaves no doubt; 0: none.
From 0.4 to 0.2 the bound falls to a twelfth and the time grows by a factor of 3."""
SMOOTH = 0.1
"""The same where a hole is crossed: there w varies smoothly, and 4e-3 of it, at most, are a hundredth of the hole."""
HALF = 1e-6
"""Distance of w from a half at which a place lies in a hole."""
ROUNDING = 1e-10
"""Error of a sum of a million solid angles."""
TRIES = 40
EDGE = 1e-9
"""Tolerance in barycentric coordinates, so that no segment passes between two triangles."""
F = types.float64


@lean_inlined
def vector_area(corners, t):
    """Half the product of two sides of a triangle: normal times area."""
    ux, uy, uz = corners[t, 3] - corners[t, 0], corners[t, 4] - corners[t, 1], corners[t, 5] - corners[t, 2]
    vx, vy, vz = corners[t, 6] - corners[t, 0], corners[t, 7] - corners[t, 1], corners[t, 8] - corners[t, 2]
    return 0.5 * (uy * vz - uz * vy), 0.5 * (uz * vx - ux * vz), 0.5 * (ux * vy - uy * vx)


@lean_inlined
def without_traces(row):
    """Take the traces from a cluster's moments, and multiply them by the numbers of the sum."""
    q, o = QUADRUPOLE, OCTUPOLE
    trace = (row[q] + row[q + 1] + row[q + 2]) / 3.0
    for k in range(3):
        row[q + k] -= trace
    for k in range(6):
        row[q + k] *= -3.0
    # Off the diagonal the rows hold a component times its number of orders: three of xxy.
    tx = 0.2 * (row[o] + (row[o + 5] + row[o + 7]) / 3.0)
    ty = 0.2 * (row[o + 1] + (row[o + 3] + row[o + 8]) / 3.0)
    tz = 0.2 * (row[o + 2] + (row[o + 4] + row[o + 6]) / 3.0)
    for at, trace in ((0, tx), (1, ty), (2, tz), (3, ty), (4, tz), (5, tx), (6, tz), (7, tx), (8, ty)):
        row[o + at] -= 3.0 * trace
    for k in range(10):
        row[o + k] *= 7.5


@lean(types.void(ROWS, NODES, ROWS, types.int64, types.int64))
def gather(corners, links, moments, first, last):
    """Fill the rows first..last-1 of ``moments`` (b, MOMENTS) from triangles (m, 9) in the order of the tree."""
    for node in range(first, last):
        begin, end = links[node, FIRST], links[node, FIRST] + links[node, HELD]
        if links[node, HELD] == 0:  # a node's triangles end where the last leaf in it ends
            end = links[links[node, SKIP] - 1, FIRST] + links[links[node, SKIP] - 1, HELD]
        px, py, pz, area = 0.0, 0.0, 0.0, 0.0
        for t in range(begin, end):
            ax, ay, az = vector_area(corners, t)
            size = math.sqrt(ax * ax + ay * ay + az * az)
            area += size
            px += size * (corners[t, 0] + corners[t, 3] + corners[t, 6])
            py += size * (corners[t, 1] + corners[t, 4] + corners[t, 7])
            pz += size * (corners[t, 2] + corners[t, 5] + corners[t, 8])
        if area > 0.0:
            px, py, pz = px / (3.0 * area), py / (3.0 * area), pz / (3.0 * area)
        else:
            px, py, pz = corners[begin, 0], corners[begin, 1], corners[begin, 2]
        row = moments[node]
        row[:] = 0.0
        row[CENTER], row[CENTER + 1], row[CENTER + 2], row[AREA] = px, py, pz, area
        farthest = 0.0
        for t in range(begin, end):
            nx, ny, nz = vector_area(corners, t)
            sx, sy, sz = 0.0, 0.0, 0.0
            xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for k in range(0, 9, 3):
                x, y, z = corners[t, k] - px, corners[t, k + 1] - py, corners[t, k + 2] - pz
                farthest = max(farthest, x * x + y * y + z * z)
                sx, sy, sz = sx + x, sy + y, sz + z
                xx, yy, zz = xx + x * x, yy + y * y, zz + z * z
                xy, xz, yz = xy + x * y, xz + x * z, yz + y * z
            row[DIPOLE] += nx
            row[DIPOLE + 1] += ny
            row[DIPOLE + 2] += nz
            q = QUADRUPOLE
            row[q] += nx * sx / 3.0
            row[q + 1] += ny * sy / 3.0
            row[q + 2] += nz * sz / 3.0
            row[q + 3] += (nx * sy + ny * sx) / 3.0
            row[q + 4] += (nx * sz + nz * sx) / 3.0
            row[q + 5] += (ny * sz + nz * sy) / 3.0
            # The mean of y y over a triangle is that of its corners' products and of their sum's, by 12.
            xx, yy, zz = (xx + sx * sx) / 12.0, (yy + sy * sy) / 12.0, (zz + sz * sz) / 12.0
            xy, xz, yz = (xy + sx * sy) / 12.0, (xz + sx * sz) / 12.0, (yz + sy * sz) / 12.0
            o = OCTUPOLE
            row[o] += nx * xx
            row[o + 1] += ny * yy
            row[o + 2] += nz * zz
            row[o + 3] += 2.0 * nx * xy + ny * xx
            row[o + 4] += 2.0 * nx * xz + nz * xx
            row[o + 5] += 2.0 * ny * xy + nx * yy
            row[o + 6] += 2.0 * ny * yz + nz * yy
            row[o + 7] += 2.0 * nz * xz + nx * zz
            row[o + 8] += 2.0 * nz * yz + ny * zz
            row[o + 9] += 2.0 * (nx * yz + ny * xz + nz * xy)
        row[RADIUS] = math.sqrt(farthest) * (1.0 + 1e-12)
        without_traces(row)


@lean_inlined
def solid_angle(corners, t, x, y, z):
    """Half the signed solid angle of a triangle (van Oosterom & Strackee 1983, eq. 8)."""
    ax, ay, az = corners[t, 0] - x, corners[t, 1] - y, corners[t, 2] - z
    bx, by, bz = corners[t, 3] - x, corners[t, 4] - y, corners[t, 5] - z
    cx, cy, cz = corners[t, 6] - x, corners[t, 7] - y, corners[t, 8] - z
    a = math.sqrt(ax * ax + ay * ay + az * az)
    b = math.sqrt(bx * bx + by * by + bz * bz)
    c = math.sqrt(cx * cx + cy * cy + cz * cz)
    triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    rest = a * b * c + (ax * bx + ay * by + az * bz) * c
    rest += (bx * cx + by * cy + bz * cz) * a + (cx * ax + cy * ay + cz * az) * b
    return math.atan2(triple, rest)


@lean(types.Tuple((F, F))(ROWS, NODES, ROWS, F, F, F, F))
def winds(corners, links, moments, x, y, z, widest):
    """How often the triangles wind around a point, and a bound on its error; clusters of r < ``widest`` R expanded."""
    near, far, left = 0.0, 0.0, 0.0
    node, count = 0, len(links)
    while node < count:
        row = moments[node]
        ux, uy, uz = row[0] - x, row[1] - y, row[2] - z
        square = ux * ux + uy * uy + uz * uz
        radius = row[RADIUS]
        if radius * radius < widest * widest * square:
            by = 1.0 / square
            share = radius * math.sqrt(by)
            q, o = QUADRUPOLE, OCTUPOLE
            dipole = row[DIPOLE] * ux + row[DIPOLE + 1] * uy + row[DIPOLE + 2] * uz
            quadrupole = ux * (row[q] * ux + row[q + 3] * uy + row[q + 4] * uz)
            quadrupole += uy * (row[q + 1] * uy + row[q + 5] * uz) + row[q + 2] * uz * uz
            octupole = ux * ux * (row[o] * ux + row[o + 3] * uy + row[o + 4] * uz)
            octupole += uy * uy * (row[o + 5] * ux + row[o + 1] * uy + row[o + 6] * uz)
            octupole += uz * uz * (row[o + 7] * ux + row[o + 8] * uy + row[o + 2] * uz) + row[o + 9] * ux * uy * uz
            far += (dipole + (quadrupole + octupole * by) * by) * by * math.sqrt(by)
            left += row[AREA] * by * share**3 * (4.0 - 3.0 * share) / (1.0 - share) ** 2
            node = links[node, SKIP]
            continue
        for t in range(links[node, FIRST], links[node, FIRST] + links[node, HELD]):
            near += solid_angle(corners, t, x, y, z)
        node += 1
    return near / (2.0 * math.pi) + far / (4.0 * math.pi), left / (4.0 * math.pi)


@lean(types.boolean(ROWS, NODES, ROWS, F, F, F), inner=True)
def inside(corners, links, moments, x, y, z):
    """Whether the triangles wind around a point more than half: as their exact sum says, but for its rounding."""
    w = 0.0
    for widest in WIDEST:
        w, left = winds(corners, links, moments, x, y, z, widest)
        if abs(w - 0.5) > left + ROUNDING:
            break
    return w > 0.5


@lean(types.void(ROWS, NODES, ROWS, ROWS, types.boolean[::1], types.int64, types.int64))
def hold(corners, links, moments, places, held, first, last):
    """held[k] = whether places[k] (n, 3) lies inside, for first <= k < last."""
    for k in range(first, last):
        held[k] = inside(corners, links, moments, places[k, 0], places[k, 1], places[k, 2])


MIXED = -(2**31)
"""Of a cell that a triangle may cross: places in it are asked one by one."""
CELLS = types.int32[:, :, ::1]
FEW = 8


@lean(types.void(ROWS, ROWS, types.float64, CELLS))
def mark(corners, low, side, cells):
    """Makes MIXED the cubes of a ``side``, from the corner ``low`` (1, 3) on, that triangles (m, 9) may cross."""
    nx, ny, nz = cells.shape
    room = 1e-6 * side
    for t in range(len(corners)):
        ax, ay, az = corners[t, 0] - low[0, 0], corners[t, 1] - low[0, 1], corners[t, 2] - low[0, 2]
        bx, by, bz = corners[t, 3] - low[0, 0], corners[t, 4] - low[0, 1], corners[t, 5] - low[0, 2]
        cx, cy, cz = corners[t, 6] - low[0, 0], corners[t, 7] - low[0, 1], corners[t, 8] - low[0, 2]
        i0, i1 = int((min(ax, bx, cx) - room) / side), int((max(ax, bx, cx) + room) / side)
        j0, j1 = int((min(ay, by, cy) - room) / side), int((max(ay, by, cy) + room) / side)
        k0, k1 = int((min(az, bz, cz) - room) / side), int((max(az, bz, cz) + room) / side)
        few = (i1 - i0 + 1) * (j1 - j0 + 1) * (k1 - k0 + 1) <= FEW
        px, py, pz = vector_area(corners, t)
        reach = (0.5 * side + room) * (abs(px) + abs(py) + abs(pz))
        for i in range(max(i0, 0), min(i1 + 1, nx)):
            for j in range(max(j0, 0), min(j1 + 1, ny)):
                for k in range(max(k0, 0), min(k1 + 1, nz)):
                    away = px * ((i + 0.5) * side - ax) + py * ((j + 0.5) * side - ay) + pz * ((k + 0.5) * side - az)
                    if few or abs(away) <= reach:
                        cells[i, j, k] = MIXED


@lean(types.int64(ROWS, NODES, ROWS, ROWS, NODES, ROWS, F, F, F))
def turns(corners, links, moments, lids, lid_links, lid_moments, x, y, z):
    """How often triangles wind around a point together with the lids that close them: a whole number."""
    w = 0.0
    for widest in WIDEST:
        one, left = winds(corners, links, moments, x, y, z, widest)
        other, lost = winds(lids, lid_links, lid_moments, x, y, z, widest)
        w = one + other
        if left + lost < 0.25:
            break
    return math.floor(w + 0.5)


@lean(types.boolean(ROWS, NODES, ROWS, F, F, F, F), inner=True)
def inside_but(lids, links, moments, turned, x, y, z):
    """As ``inside``, of triangles that wind ``turned`` times around the point together with their lids."""
    w = 0.0
    for widest in WIDEST:
        lid, left = winds(lids, links, moments, x, y, z, widest)
        w = turned - lid
        if abs(w - 0.5) > left + ROUNDING:
            break
    return w > 0.5


@lean(
    types.void(ROWS, NODES, ROWS, ROWS, NODES, ROWS, ROWS, F, CELLS, ROWS, types.boolean[::1], types.int64, types.int64)
)
def hold_in_cells(corners, links, moments, lids, lid_links, lid_moments, low, side, cells, places, held, first, last):
    """As ``hold``, by the turns around ``cells``, which are the same all over a cell that no triangle crosses."""
    for p in range(first, last):
        x, y, z = places[p, 0], places[p, 1], places[p, 2]
        u, v, w = (x - low[0, 0]) / side, (y - low[0, 1]) / side, (z - low[0, 2]) / side
        turned = MIXED
        if 0.0 <= u < cells.shape[0] and 0.0 <= v < cells.shape[1] and 0.0 <= w < cells.shape[2]:
            turned = cells[int(u), int(v), int(w)]
        if turned == MIXED:
            held[p] = inside(corners, links, moments, x, y, z)
        elif len(lids) == 0:
            held[p] = turned > 0
        else:
            held[p] = inside_but(lids, lid_links, lid_moments, float(turned), x, y, z)


@lean_inlined
def meets_box(boxes, node, x, y, z, dx, dy, dz, after, until):
    """Whether the part after..until of a segment may meet a box."""
    for k in range(3):
        at, way = (x, dx) if k == 0 else ((y, dy) if k == 1 else (z, dz))
        low, high = boxes[node, k] - at, boxes[node, k + 3] - at
        if way == 0.0:
            if low > 0.0 or high < 0.0:
                return False
            continue
        a, b = low / way, high / way
        after, until = max(after, min(a, b)), min(until, max(a, b))
    return after <= until


@lean(F(ROWS, NODES, ROWS, F, F, F, F, F, F, F), inner=True)
def meets(corners, links, boxes, x, y, z, dx, dy, dz, after):
    """Fraction in (after, 1] at which a segment first meets a triangle (Moeller & Trumbore 1997); inf where none is."""
    nearest = math.inf
    node, count = 0, len(links)
    while node < count:
        if not meets_box(boxes, node, x, y, z, dx, dy, dz, after, min(1.0, nearest)):
            node = links[node, SKIP]
            continue
        for t in range(links[node, FIRST], links[node, FIRST] + links[node, HELD]):
            ax, ay, az = x - corners[t, 0], y - corners[t, 1], z - corners[t, 2]
            ux, uy, uz = corners[t, 3] - corners[t, 0], corners[t, 4] - corners[t, 1], corners[t, 5] - corners[t, 2]
            vx, vy, vz = corners[t, 6] - corners[t, 0], corners[t, 7] - corners[t, 1], corners[t, 8] - corners[t, 2]
            px, py, pz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
            qx, qy, qz = ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux
            whole = px * ux + py * uy + pz * uz
            u = (px * ax + py * ay + pz * az) / whole
            v = (qx * dx + qy * dy + qz * dz) / whole
            s = (qx * vx + qy * vy + qz * vz) / whole
            if u >= -EDGE and v >= -EDGE and u + v <= 1.0 + EDGE and after < s and s <= 1.0:
                nearest = min(nearest, s)
        node += 1
    return nearest


@lean(F(ROWS, NODES, ROWS, F, F, F, F, F, F, F), inner=True)
def through_hole(corners, links, moments, x, y, z, dx, dy, dz, low):
    """Fraction low..1 of a segment at which w falls through a half (Dowell & Jarratt 1971, Illinois)."""
    high, last = 1.0, 0
    above = winds(corners, links, moments, x + low * dx, y + low * dy, z + low * dz, SMOOTH)[0] - 0.5
    below = winds(corners, links, moments, x + dx, y + dy, z + dz, SMOOTH)[0] - 0.5
    for _ in range(TRIES):
        share = above / (above - below) if above > 0.0 > below else 0.5
        s = low + share * (high - low)
        w = winds(corners, links, moments, x + s * dx, y + s * dy, z + s * dz, SMOOTH)[0] - 0.5
        if abs(w) < HALF:
            return s
        if w > 0.0:
            low, above = s, w
            below *= 0.5 if last > 0 else 1.0
            last = 1
        else:
            high, below = s, w
            above *= 0.5 if last < 0 else 1.0
            last = -1
    return 0.5 * (low + high)


@lean(types.void(ROWS, NODES, ROWS, ROWS, ROWS, ROWS, types.float64[::1], types.int64, types.int64))
def leave(corners, links, moments, boxes, inner, outer, shares, first, last):
    """shares[k] = fraction (0..1) at which the segment from inner[k] (n, 3) inside to outer[k] outside leaves.

    That is the first triangle behind which it is outside, or in a hole where the triangles wind around it by half.
    """
    for k in range(first, last):
        x, y, z = inner[k, 0], inner[k, 1], inner[k, 2]
        dx, dy, dz = outer[k, 0] - x, outer[k, 1] - y, outer[k, 2] - z
        low, found = 0.0, False
        at = meets(corners, links, boxes, x, y, z, dx, dy, dz, -1e-300)
        while at <= 1.0 and not found:
            low = at
            at = meets(corners, links, boxes, x, y, z, dx, dy, dz, low)
            behind = 0.5 * (low + min(at, 1.0))
            found = not inside(corners, links, moments, x + behind * dx, y + behind * dy, z + behind * dz)
        if found:
            shares[k] = low
        else:
            shares[k] = through_hole(corners, links, moments, x, y, z, dx, dy, dz, low)
