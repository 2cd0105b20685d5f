# mypy: ignore-errors
"""Implicit objects by fixed samples along the ray and bisection: a comparison for the certified search."""

from renderers.tracing import layout
from renderers.tracing.scene_kernels import CROSSING
from renderers.tracing.solids.ranges_kernels import box_part, is_sheet, tape_of
from renderers.tracing.solids.solids_kernels import NONE
from sceneql.compiled.kernels import kernel
from sceneql.field.roots.bracket_kernels import along

HALVINGS = 60
"""Bisections of the piece between two samples: to the last bit."""


@kernel(CROSSING.signature, _nrt=False, inner=True)
def sampled(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """Crossing of implicit object k behind ``near``: the first change of sign between SAMPLES + 1 places on the ray.

    Pairs of roots between two places are missed, and nothing is undecided.
    """
    code, constants, parts = tape_of(scene, k)
    code_within, constants_within, parts_within = tape_of(scene, k, layout.WITHIN)
    thin = is_sheet(scene, k)
    enter, stop = box_part(scene, k, ox, oy, oz, dx, dy, dz, near, far)
    if not enter < stop:
        return NONE
    count = int(scene.reals[layout.SAMPLES])
    inside = along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, enter) < 0.0
    if inside and not thin and (anywhere or enter > near):
        return enter
    a = enter
    for i in range(1, count + 1):
        b = enter + (stop - enter) * i / count
        if (along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, b) < 0.0) == inside:
            a = b
            continue
        last = b
        for _ in range(HALVINGS):
            t = 0.5 * (a + b)
            if (along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t) < 0.0) == inside:
                a = t
            else:
                b = t
        if not thin:
            return b
        if along(code_within, constants_within, parts_within, scratch, ox, oy, oz, dx, dy, dz, b) < 0.0:
            return b
        a = last
        inside = not inside
    return stop if inside and not thin and stop < far else NONE
