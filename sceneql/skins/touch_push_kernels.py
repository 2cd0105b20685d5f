# mypy: ignore-errors
"""The pressure by which contacts push a skin off, over its own stiffness, by the distance as a part of the gap.

That of the barrier of elastic solids, which goes as 1/s, and from three tenths of the gap on as 1/s^7: there the
distance left goes as the load to -1/7, and how fast the load grows along it is seven loads by the distance. So what
presses 10^4 times harder than a skin pulls leaves a tenth of the gap and lets steps be, where the barrier alone would
leave a ten thousandth of it and ask for steps ten times as short.
"""

from sceneql.compiled.kernels import lean_inlined
from sceneql.contacts.barrier.barrier_kernels import push as barrier

STEEP = 0.3
"""Part of the gap where it begins to be steeper: what starts further off is not thrown off."""


@lean_inlined
def push(s):
    """Of a distance above 0; NaN where surfaces touch."""
    more = STEEP / s if s > 0.0 else 0.0
    cube = more * more * more
    return barrier(s) * (1.0 + cube * cube)
