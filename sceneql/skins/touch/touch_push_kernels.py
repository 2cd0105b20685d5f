# mypy: ignore-errors
"""The pressure by which contacts push a skin off, over its own stiffness, by the distance s as a part of the gap.

That of the barrier of elastic solids, which goes as 1/s, and from a part of the gap on (touch_layout.py) as 1/s^7:
there the distance left goes as the load to -1/7, and how fast the load grows along it is seven loads by the distance.
So what presses 10^4 times harder than a skin pulls leaves a tenth of the gap and lets steps be, where the barrier alone
would leave a ten thousandth of it and ask for steps ten times as short.
"""

from sceneql.compiled.kernels import lean_inlined
from sceneql.contacts.barrier.barrier_kernels import push as barrier


@lean_inlined
def push(s, steep):
    """Of a distance above 0, ``steep`` from where on it is steeper; NaN where surfaces touch."""
    more = steep / s if s > 0.0 else 0.0
    cube = more * more * more
    return barrier(s) * (1.0 + cube * cube)
