# mypy: ignore-errors
"""Gradients of a tape at many points by forward differentiation, after ``batch_kernels.evaluate`` at these points."""

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.enclose.sine_kernels import wave_lanes
from sceneql.field.skeleton.density_kernels import offset
from sceneql.field.skeleton.skeleton_kernels import skeleton_gradient
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.batch_kernels import BATCH
from sceneql.field.tape.gradient_kernels import slopes


@inlined
def point_slopes(parts, start, stop, x, y, z, gx, gy, gz, n):
    """``density_gradient`` at n points for parts that are points; False, and nothing done, where one is a segment."""
    for part in range(start, stop):
        for axis in range(3):
            if parts[part, axis] != parts[part, 3 + axis]:
                return False
    for i in range(n):
        gx[i] = gy[i] = gz[i] = 0.0
    for part in range(start, stop):
        ax, ay, az = parts[part, 0], parts[part, 1], parts[part, 2]
        radius2 = parts[part, 6] * parts[part, 6]
        scale = -6.0 * parts[part, 7] / radius2
        for i in range(n):
            wx, wy, wz = x[i] - ax, y[i] - ay, z[i] - az
            u = 1.0 - (wx * wx + wy * wy + wz * wz) / radius2
            u = u if u > 0.0 else 0.0
            slope = scale * (u * u)
            gx[i] += slope * wx
            gy[i] += slope * wy
            gz[i] += slope * wz
    return True


@inlined
def density_lanes(parts, start, stop, x, y, z, out, n):
    """``density_gradient`` at n points into out (3, LANES)."""
    for axis in range(3):
        for i in range(n):
            out[axis, i] = 0.0
    for part in range(start, stop):
        square = parts[part, 6] * parts[part, 6]
        factor = -6.0 * parts[part, 7]
        point = (
            parts[part, 0] == parts[part, 3] and parts[part, 1] == parts[part, 4] and parts[part, 2] == parts[part, 5]
        )
        for i in range(n):
            wx = x[i] - parts[part, 0]
            wy = y[i] - parts[part, 1]
            wz = z[i] - parts[part, 2]
            if not point:
                wx, wy, wz = offset(parts, part, x[i], y[i], z[i])
            u = 1.0 - (wx * wx + wy * wy + wz * wz) / square
            slope = factor * u * u / square
            out[0, i] += slope * wx if u > 0.0 else 0.0
            out[1, i] += slope * wy if u > 0.0 else 0.0
            out[2, i] += slope * wz if u > 0.0 else 0.0


@inlined
def of_parts(code, k, parts, registers, slope, n):
    """Gradient of the density of row k, by the chain rule through the point at which the row is asked."""
    p = code[k, 3]
    if code[k, 0] == ops.DENSITY:
        density_lanes(
            parts, code[k, 1], code[k, 2], registers[p], registers[p + 1], registers[p + 2], slope[k], n
        )  # fmt: skip
    else:
        for i in range(n):
            x, y, z = registers[p, i], registers[p + 1, i], registers[p + 2, i]
            slope[k, 0, i], slope[k, 1, i], slope[k, 2, i] = skeleton_gradient(
                parts, code[k, 1], code[k, 2], x, y, z
            )  # fmt: skip
    for i in range(n):
        u, v, w = slope[k, 0, i], slope[k, 1, i], slope[k, 2, i]
        for axis in range(3):
            slope[k, axis, i] = u * slope[p, axis, i] + v * slope[p + 1, axis, i] + w * slope[p + 2, axis, i]


@inlined
def any_slopes(op, value, a, b, slope_a, slope_b, slope, n):
    """Gradient of an operation of one or two arguments by its partial derivatives."""
    if op == ops.MAX or op == ops.MIN:
        for axis in range(3):
            ga, gb, g = slope_a[axis], slope_b[axis], slope[axis]
            for i in range(n):
                first = a[i] > b[i] if op == ops.MAX else a[i] < b[i]
                g[i] = ga[i] if first else 0.0 + gb[i]  # the sign of a zero is that of ``gradient``
        return
    if op == ops.SQRT:
        for axis in range(3):
            ga, g = slope_a[axis], slope[axis]
            for i in range(n):
                u = 0.5 / value[i] if value[i] > 0.0 else 0.0
                g[i] = u * ga[i] if u != 0.0 else 0.0
        return
    for i in range(n):
        u, v = slopes(op, value[i], a[i], b[i])
        for axis in range(3):
            # A zero slope is skipped: zero times an infinite slope of the branch not taken would be NaN.
            g = 0.0
            if u != 0.0:
                g = u * slope_a[axis, i]
            if v != 0.0:
                g += v * slope_b[axis, i]
            slope[axis, i] = g


@inlined
def wave_slopes(op, a, slope_a, slope, n):
    """Gradient of a sine or cosine."""
    factor = slope[2]  # overwritten last: the factor is stored in the z slope
    wave_lanes(a, factor, n, op == ops.SIN)
    sign = 1.0 if op == ops.SIN else -1.0
    for axis in range(3):
        for i in range(n):
            u = sign * factor[i]
            slope[axis, i] = u * slope_a[axis, i] if u != 0.0 else 0.0


@lean(f"void({BATCH}, float64[:, :, ::1], int64)")
def differentiate(code, constants, parts, registers, slope, n):
    """Gradients into ``slope`` (rows, 3, LANES), those of f in its row of the last operation.

    Those of rows that KEEP are there.
    """
    for k in range(code.shape[0]):
        op = code[k, 0]
        if op == ops.KEEP:
            continue
        left = code[k, 1]
        right = code[k, 2]
        out = slope[k]
        if op == ops.CONSTANT or op == ops.X or op == ops.Y or op == ops.Z:
            for axis in range(3):
                number = 1.0 if op - ops.X == axis else 0.0
                for i in range(n):
                    out[axis, i] = number
            continue
        if op == ops.DENSITY and code[code[k, 3], 0] == ops.X and code[code[k, 3] + 2, 0] == ops.Z:
            p = code[k, 3]
            if point_slopes(
                parts, left, right, registers[p], registers[p + 1], registers[p + 2], out[0], out[1], out[2], n
            ):  # fmt: skip
                continue
        if op == ops.DENSITY or op == ops.SKELETON:
            of_parts(code, k, parts, registers, slope, n)
            continue
        a = registers[left]
        b = registers[right]
        if op == ops.SIN or op == ops.COS:
            wave_slopes(op, a, slope[left], out, n)
            continue
        for axis in range(3):
            da = slope[left, axis]
            db = slope[right, axis]
            g = out[axis]
            if op == ops.ADD:
                for i in range(n):
                    g[i] = da[i] + db[i]
            elif op == ops.SUB:
                for i in range(n):
                    g[i] = da[i] - db[i]
            elif op == ops.MUL:
                # A zero factor is skipped, as by ``gradient``, and zeros have the same sign.
                for i in range(n):
                    one = b[i] * da[i] if b[i] != 0.0 else 0.0
                    g[i] = one + a[i] * db[i] if a[i] != 0.0 else one
            elif op == ops.SQUARE:
                for i in range(n):
                    g[i] = 2.0 * a[i] * da[i] if a[i] != 0.0 else 0.0
            elif op == ops.NEG:
                for i in range(n):
                    g[i] = -da[i]
            elif op == ops.COPY:
                for i in range(n):
                    g[i] = da[i]
        if not (op == ops.ADD or op == ops.SUB or op == ops.MUL or op == ops.SQUARE or op == ops.NEG or op == ops.COPY):
            any_slopes(op, registers[k], a, b, slope[left], slope[right], out, n)
