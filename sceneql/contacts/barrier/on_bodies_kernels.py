# mypy: ignore-errors
"""What places of rigid bodies (system.Place) do in a barrier: compiled where there are any."""

from numba import types

from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.system.signatures_kernels import A, F, I, N

THREE = types.UniTuple(F, 3)
PLACES, TURNING, STRUCK = (
    "sceneql.bodies.rigid.place_kernels",
    "sceneql.contacts.barrier.turning_kernels",
    "sceneql.contacts.barrier.struck_body_kernels",
)

on_body = lazy(f"{PLACES}:position", THREE(A, A, I, N))
speed_on_body = lazy(f"{PLACES}:velocity", THREE(A, A, I, N))
push_body = lazy(f"{PLACES}:push", F(A, A, A, I, N, F, F, F))
swept = lazy(f"{TURNING}:swept", THREE(A, A, A, I, N, F))
turned = lazy(f"{TURNING}:turned", F(A, A, A, I, N))
strike_body = lazy(f"{STRUCK}:strike", types.void(A, A, I, N, F, F, F))
lightness_of_body = lazy(f"{STRUCK}:lightness", F(A, I, N))
