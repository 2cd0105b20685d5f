# mypy: ignore-errors
"""Light paths followed to their ends in waves, all of it in one call, where packets know one solid.

Packets, and lanes of plain items beside, are called by their addresses.
"""

from numba import types

from renderers.tracing import layout
from renderers.tracing.light.bounce_kernels import WAYS, dress_hits, look_about
from renderers.tracing.light.plain_ways_kernels import LINE, begin_ways, end_ways, list_steps, tell_steps
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH
from renderers.tracing.solids.bundles_kernels import SOLID
from renderers.tracing.solids.skins_kernels import HITS, MEMORY
from sceneql.compiled.kernels import function_at, lean

_i = types.int64
_many = types.int64[::1]
PLAIN = types.FunctionType(types.void(SCENE, ASKED, LINE))
SKIN = types.FunctionType(types.void(*HITS, *MEMORY))
MEET = types.FunctionType(types.void(*SOLID))
plain_at, skin_at, meet_at = map(function_at, (PLAIN, SKIN, MEET))


@lean(
    types.void(
        SCENE, SCRATCH, ASKED, WAYS, _i, _i, _many, _many, WAYS, WAYS, LINE, _i, _i, _i, types.Tuple(MEMORY),
        types.Tuple(SOLID),
    )
)  # fmt: skip
def follow_ways(
    scene, scratch, asked, ways, first, few, live, hits, met, skins, lanes, plain, skin, meet, of_skins, of_solid
):  # fmt: skip
    """Follow the ``ways`` from the ``first`` on to their ends, in waves; the last ones, fewer than ``few``, singly.

    ``plain`` (or 0), ``skin``, ``meet``: addresses of ``plain_lanes_kernels.meet_plain``, ``skins_kernels.skin_hits``
    and ``bundles_kernels.meet_asked``; ``lanes``, ``of_skins`` and ``of_solid``: what these take. ``live``, ``hits``,
    ``met`` and ``skins`` are working memory.
    """
    count = begin_ways(asked, first, live)
    while True:
        count, some = look_about(scene, scratch, ways, live, count, hits, met)
        if count < few:
            end_ways(scene, scratch, asked, ways, live[:count])
            return
        if some > 0:
            skin_at(skin)(scene, hits[:some], met, skins, *of_skins)
            dress_hits(ways, hits[:some], skins)
        start = 0
        while start < count:
            end = list_steps(scene, scratch, asked, ways, live, start, count)
            if asked[0, layout.NEXT] > 1:
                meet_at(meet)(*of_solid)
                if plain != 0:
                    plain_at(plain)(scene, asked, lanes)
            start = tell_steps(scene, scratch, asked, ways, live, start, end)
