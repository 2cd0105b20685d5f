# mypy: ignore-errors
"""Light paths followed to their ends in waves, all of it in one call: most waves are of few rays, and a call costs
as much as some hundred of these. Packets of one solid, and lanes of plain items, are called by their addresses."""

from numba import types

from renderers.tracing import layout
from renderers.tracing.light.bounce_kernels import WAYS, dress_hits, follow_all, look_about, step_all
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH
from renderers.tracing.solids.bundles_kernels import SOLID
from renderers.tracing.solids.skins_kernels import HITS, MEMORY
from sceneql.compiled.kernels import function_at, lean

_i = types.int64
_many = types.int64[::1]
LINE = types.float64[::1]
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

    ``plain``, ``skin`` and ``meet``: addresses of ``plain_lanes_kernels.meet_plain``, ``skins_kernels.skin_hits`` and
    ``bundles_kernels.meet_asked``, or 0; ``lanes``, ``of_skins`` and ``of_solid``: what these take. ``live``,
    ``hits``, ``met`` and ``skins`` are working memory.
    """
    count = int(asked[0, layout.WAYS]) - first
    for i in range(count):
        live[i] = first + i
    while True:
        count, some = look_about(scene, scratch, ways, live, count, hits, met)
        if count < few:
            asked[0, layout.MODE] = layout.PLAIN
            follow_all(scene, scratch, asked, ways, live[:count])
            return
        if some > 0 and skin != 0:
            skin_at(skin)(scene, hits[:some], met, skins, *of_skins)
            dress_hits(ways, hits[:some], skins)
        start = 0
        while start < count:
            asked[0, layout.MODE], asked[0, layout.NEXT] = layout.ASKING, 1
            end = step_all(scene, scratch, asked, ways, live, start, count)
            if asked[0, layout.NEXT] > 1:
                if meet != 0:
                    meet_at(meet)(*of_solid)
                if plain != 0:
                    plain_at(plain)(scene, asked, lanes)
            asked[0, layout.MODE], asked[0, layout.NEXT] = layout.TELLING, 1
            step_all(scene, scratch, asked, ways, live, start, end)
            start = end
