# mypy: ignore-errors
"""The enclosure of a whole tape in lanes: see ``packet_kernels``. Not compiled for bundles of a density alone."""

import numpy as np

from sceneql.compiled.kernels import lean
from sceneql.field.enclose.affine_kernels import ZERO, F
from sceneql.field.enclose.forms_kernels import row_never_negative
from sceneql.field.packets import packet_kernels as packet
from sceneql.field.packets.packet_density_kernels import density_lanes
from sceneql.field.packets.packet_kernels import C1, LANES, E
from sceneql.field.tape import tape_ops as ops


@lean(packet.ENCLOSE, inner=True)
def enclose(code, constants, parts, registers, point, status, n):
    """Enclose f in n lanes, into the last operation's register; ``status`` (LANES,) gets WHOLE, PARTIAL or NOWHERE.

    Nothing is claimed of a lane in which c0, c1 or e is not finite. ``parts`` are those of packet_parts.
    """
    for i in range(n):
        status[i] = ZERO
    for k in range(code.shape[0]):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        out = registers[k]
        if op == ops.CONSTANT:
            continue
        if op >= ops.X and op <= ops.Z:
            p = point[op - ops.X]
            for i in range(3 * LANES):
                out[i] = p[i]
            continue
        if op == ops.DENSITY:
            p = code[k, 3]
            density_lanes(parts, left, right, registers[p], registers[p + 1], registers[p + 2], out, n)
            continue
        if op == ops.SKELETON:
            p = code[k, 3]
            packet.skeleton_lanes(parts, left, right, registers[p], registers[p + 1], registers[p + 2], out, n)
            continue
        a = registers[left]
        b = registers[right]
        if op == ops.MUL:
            if code[left, 0] == ops.CONSTANT:
                packet.scale_lanes(b, a, out, n)
            elif code[right, 0] == ops.CONSTANT:
                packet.scale_lanes(a, b, out, n)
            else:
                packet.common_lanes(op, a, b, out, n)
        elif op == ops.ADD or op == ops.SUB or op == ops.SQUARE:
            packet.common_lanes(op, a, b, out, n)
        elif op == ops.NEG:
            for i in range(n):
                out[i] = -a[i]
                out[C1 + i] = -a[C1 + i]
                out[E + i] = a[E + i]
        elif op == ops.COPY:
            for i in range(3 * LANES):
                out[i] = a[i]
        elif op == ops.SIN or op == ops.COS:
            twin = registers[code[k, 3] if code[k, 3] else k]
            if code[k, 3] == 0:
                packet.turn_lanes(a, out, n)
            packet.wave_lanes(op, a, out, twin, n)
        elif op <= ops.ATAN2:
            packet.binary_lanes(op, a, b, out, n, status, row_never_negative(code, left))
        elif op <= ops.SIGN:
            packet.unary_lanes(op, a, out, n, status, row_never_negative(code, left))
        else:  # operations without a lane version get no bound
            for i in range(n):
                out[i] = F(np.nan)
