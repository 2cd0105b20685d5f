# mypy: ignore-errors
"""Accessors of an implicit object's data in the scene's arrays."""

from renderers.tracing import layout
from renderers.tracing.scene_kernels import part
from renderers.tracing.solids.solids_kernels import box_span, inverse


@part
def tape_of(scene, k, first=0):
    """(code, constants, parts) of the implicit object whose reals begin at k.

    Its own tape has the ranges from ``first`` = 0 on, the others from PAINT and from WITHIN on.
    """
    return tape_at(scene, int(scene.reals[k + 6]) + first)


@part
def tape_at(scene, r):
    """(code, constants, parts) of the tape whose ranges begin at r in the ints."""
    n = scene.ints
    code, constants, parts = int(n[r]), int(n[r + 2]), int(n[r + 4])
    return (
        n[code : code + 4 * n[r + 1]].reshape(n[r + 1], 4),
        scene.reals[constants : constants + n[r + 3]],
        scene.reals[parts : parts + 8 * n[r + 5]].reshape(n[r + 5], 8),
    )


@part
def cells_at(scene, k):
    """Place of the occupancy cells of the implicit object whose reals begin at k."""
    return scene.ints[int(scene.reals[k + 6]) + layout.CELLS_AT]


@part
def plan_at(scene, k):
    """(begin, end) of the plan for single rays of implicit object k (sceneql.field.tape.plans)."""
    r = int(scene.reals[k + 6]) + layout.PLAN
    return scene.ints[r], scene.ints[r] + scene.ints[r + 1]


@part
def is_sheet(scene, k):
    """Whether implicit object k is a sheet, not a solid."""
    return scene.ints[int(scene.reals[k + 6]) + layout.WITHIN + 1] > 0


@part
def box_part(scene, k, ox, oy, oz, dx, dy, dz, near, far):
    """(from, to) of the ray inside the box of implicit object k."""
    b = scene.reals
    enter = near
    leave = far
    e, f = box_span(b[k], b[k + 3], ox, inverse(dx))
    enter = max(enter, e)
    leave = min(leave, f)
    e, f = box_span(b[k + 1], b[k + 4], oy, inverse(dy))
    enter = max(enter, e)
    leave = min(leave, f)
    e, f = box_span(b[k + 2], b[k + 5], oz, inverse(dz))
    return max(enter, e), min(leave, f)
