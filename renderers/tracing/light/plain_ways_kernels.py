# mypy: ignore-errors
"""Light paths followed to their ends in waves, all of it in one call, in scenes of a few plain items.

Most waves are of few rays, and a call from Python costs as much as some hundred of these.
"""

from numba import types

from renderers.tracing import layout
from renderers.tracing.light.bounce_kernels import WAYS, follow_all, look_about, step_all
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, part
from renderers.tracing.solids.plain_lanes_kernels import meet_plain
from sceneql.compiled.kernels import lean

_i = types.int64
_many = types.int64[::1]
LINE = types.float64[::1]


@part
def begin_ways(asked, first, live):
    """List the ways from the ``first`` on; returns their number."""
    count = int(asked[0, layout.WAYS]) - first
    for i in range(count):
        live[i] = first + i
    return count


@part
def end_ways(scene, scratch, asked, ways, live):
    """Follow the last few ways singly."""
    asked[0, layout.MODE] = layout.PLAIN
    follow_all(scene, scratch, asked, ways, live)


@part
def list_steps(scene, scratch, asked, ways, live, start, count):
    """List the rays of a step of the ways ``live[start:count]``; returns the end of those that fit."""
    asked[0, layout.MODE], asked[0, layout.NEXT] = layout.ASKING, 1
    return step_all(scene, scratch, asked, ways, live, start, count)


@part
def tell_steps(scene, scratch, asked, ways, live, start, end):
    """Take that step by the answers; returns its end."""
    asked[0, layout.MODE], asked[0, layout.NEXT] = layout.TELLING, 1
    return step_all(scene, scratch, asked, ways, live, start, end)


@lean(types.void(SCENE, SCRATCH, ASKED, WAYS, _i, _i, _many, _many, WAYS, LINE))
def follow_plain(scene, scratch, asked, ways, first, few, live, hits, met, lanes):
    """Follow the ``ways`` from the ``first`` on to their ends, in waves; the last ones, fewer than ``few``, singly.

    ``live``, ``hits``, ``met``, and ``lanes`` of ``meet_plain``, are working memory.
    """
    count = begin_ways(asked, first, live)
    while True:
        count, _ = look_about(scene, scratch, ways, live, count, hits, met)
        if count < few:
            end_ways(scene, scratch, asked, ways, live[:count])
            return
        start = 0
        while start < count:
            end = list_steps(scene, scratch, asked, ways, live, start, count)
            if asked[0, layout.NEXT] > 1:
                meet_plain(scene, asked, lanes)
            start = tell_steps(scene, scratch, asked, ways, live, start, end)
