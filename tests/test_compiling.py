"""What the compilation of kernels leaves out is not missed."""

import gc
import math
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import product

import numba
import numpy as np
import pytest
from numba import types
from numba.core.runtime import _nrt_python, rtsys

from sceneql.compiled.kernels import HELPER, MODE, PIPELINE
from sceneql.compiled.numba.collecting import collecting_later
from sceneql.words.forces.gravity_kernels import acceleration, gravity

helper = numba.njit(**HELPER)
compiled = pytest.mark.skipif(MODE == "uncompiled", reason="nothing is compiled")
shortened = pytest.mark.skipif(MODE != "shortcuts", reason="without the shortcuts Python may call every function")


@helper
def larger(a, b):
    return max(a, b)


@helper
def norm(values):
    total = 0.0
    for k in range(len(values)):
        total += larger(values[k], -values[k]) ** 2
    return math.sqrt(total)


@compiled
def test_helpers_of_helpers_reach_the_machine_code_of_the_kernel_that_calls_them():
    kernel = numba.njit(types.float64(types.float64[::1]), **PIPELINE)(lambda v: norm(v) + norm(-v))
    values = np.random.default_rng(1).normal(size=100)
    assert kernel(values) == pytest.approx(2.0 * np.linalg.norm(values), rel=1e-14)


@shortened
def test_loops_over_lanes_become_loops_over_vectors():
    from sceneql.field.packets.packet_kernels import unary_lanes

    def kernel(op, registers, status, lanes):
        unary_lanes(op, registers[0], registers[1], lanes, status, False)

    signature = types.void(types.int64, types.float32[:, ::1], types.float32[::1], types.int64)
    made = numba.njit(signature, _nrt=False, error_model="numpy", **PIPELINE)(kernel)
    (code,) = made.inspect_llvm().values()
    in_vectors, one_by_one = len(re.findall(r"fmul <\d+ x float>", code)), code.count("fmul float")
    assert in_vectors > one_by_one, "enclosures take five times as long"


@shortened
def test_a_helper_refuses_to_be_called_from_python():
    kernel = numba.njit(types.float64(types.float64[::1]), **PIPELINE)(lambda v: norm(v))
    assert kernel(np.ones(4)) == 2.0
    with pytest.raises(KeyError, match="norm is for kernels only"):
        norm(np.ones(4))


@pytest.mark.parametrize(("asked", "told"), [("plain", ""), ("", ""), ("fast", "SCENEQL_NUMBA is 'fast'")])
def test_numba_is_taken_as_it_is_where_that_is_asked_for(tmp_path, asked, told):
    code = """if True:
        import numba.core.typeinfer as numba, sys
        own = numba.ConstraintNetwork.propagate
        from sceneql.compiled.kernels import CACHE
        own = own is numba.ConstraintNetwork.propagate
        print(own, "sceneql.compiled.numba.shortcuts" in sys.modules, CACHE.folder.name)
    """
    environment = {**os.environ, "SCENEQL_NUMBA": asked, "SCENEQL_CACHE": str(tmp_path), "NUMBA_DISABLE_JIT": "0"}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    if told:
        assert told in run.stderr
    else:
        kept, shortened, cache = run.stdout.split()
        assert (kept, shortened) == (("True", "False") if asked else ("False", "True"))
        assert cache == f"numba-{numba.__version__}-{asked or 'shortcuts'}"


@shortened
def test_an_inner_kernel_is_called_by_kernels_and_refuses_python():
    with pytest.raises(TypeError, match="gravity is for kernels only"):
        gravity(0.0, *[np.zeros(3)] * 3, np.zeros(3, np.int64))


@compiled
def test_the_way_from_python_into_a_kernel_is_made_once_and_takes_what_the_kernel_does():
    floats = np.array([0.0, -3.0, 4.0, 10.0])
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: acceleration(floats, 0, 0, 3), range(8)))
    assert found == [pytest.approx((0.0, -6.0, 8.0))] * 8
    with pytest.raises(TypeError, match="No matching definition"):
        acceleration(floats.astype(np.float32), 0, 0, 3)
    with pytest.raises(TypeError, match="not enough arguments"):
        acceleration(floats, 0)


def test_a_lazy_kernel_is_there_from_its_first_call_on_and_not_before():
    import lazy_calling_kernels

    assert lazy_calling_kernels.half_of_positive(-3.0) == 0.0
    assert "lazy_called_kernels" not in sys.modules
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lazy_calling_kernels.half_of_positive, [3.0, 5.0, 7.0, 9.0])) == [1.5, 2.5, 3.5, 4.5]
    assert "lazy_called_kernels" in sys.modules
    if not numba.config.DISABLE_JIT:
        with pytest.raises(TypeError, match="halved is for kernels only"):
            lazy_calling_kernels.halved(3.0, 2)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="where numba is switched off, nothing is linked")
def test_a_lazy_kernel_that_cannot_be_brought_ends_the_call_with_the_reason_each_time():
    import lazy_calling_kernels

    assert lazy_calling_kernels.twice_by_mistake(-1.0) == 0.0
    for _ in range(2):
        with pytest.raises(TypeError, match=r"doubles is called as .* but is .*Array"):
            lazy_calling_kernels.twice_by_mistake(1.0)
    with ThreadPoolExecutor(2) as pool, pytest.raises(TypeError, match="doubles is called as"):
        list(pool.map(lazy_calling_kernels.twice_by_mistake, [1.0, 2.0]))


BESIDE = """
import sys, threading
THREAD
from sceneql.compiled import compile_beside as beside
from sceneql.compiled.kernels import compiled
wait = beside.compile_beside(sys.argv[1:])
wait()
print(compiled.count, beside._beside.cache_info().currsize)
"""


@compiled
@pytest.mark.parametrize(
    ("threads", "begun"),
    [
        (1, ""),
        pytest.param(2, "", id="a copy of the process"),
        pytest.param(2, "threading.Thread(target=threading.Event().wait, daemon=True).start()", id="a new process"),
    ],
)
def test_what_is_compiled_beside_is_there_and_asks_for_no_process_again(tmp_path, threads, begun):
    modules = [f"sceneql.words.forces.{word}_kernels" for word in ("gravity", "drag")]
    environment = {**os.environ, "SCENEQL_CACHE": str(tmp_path), "SCENEQL_THREADS": str(threads)}

    def run():
        said = subprocess.run(
            [sys.executable, "-c", BESIDE.replace("THREAD", begun), *modules],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        return tuple(map(int, said.split()))

    here, processes = run()
    assert processes == threads - 1
    assert here > 0 or threads > 1
    assert run() == (0, 0)


@compiled
def test_numbers_of_another_type_get_another_signature():
    of = {}
    for kind in (types.int64, types.float64, types.float32):
        kernel = numba.njit((kind, kind), **PIPELINE)(lambda a, b: larger(a, b) * b + a)
        of[kind] = kernel.nopython_signatures[0].return_type
    assert of == {types.int64: types.int64, types.float64: types.float64, types.float32: types.float32}


def test_the_collector_is_on_again_after_a_failure():
    def fail():
        with collecting_later():
            assert not gc.isenabled()
            raise ZeroDivisionError

    assert gc.isenabled()
    with pytest.raises(ZeroDivisionError):
        fail()
    assert gc.isenabled()


@compiled
def test_new_arrays_are_as_numpy_makes_them():
    @numba.njit(**PIPELINE)
    def made(n, m):
        plain, whole, table = np.zeros(n), np.zeros(m, dtype=np.int32), np.zeros((n, m), np.uint8)
        room = np.empty((m, n, 2), dtype=np.float32)
        room[:] = 3.0
        return plain, whole, table, room

    for one, like in zip(made(3, 5), made.py_func(3, 5), strict=True):
        assert (one.dtype, one.shape, one.strides) == (like.dtype, like.shape, like.strides)
        assert np.array_equal(one, like)
    assert [one.size for one in made(0, 4)] == [0, 4, 0, 0]
    with pytest.raises(ValueError, match="negative dimensions"):
        made(-1, 2)
    with pytest.raises(ValueError, match="too big"):
        made(1, 2**62)


@compiled
def test_least_and_most_are_those_of_python_of_nan_and_of_mixed_types():
    @numba.njit(**PIPELINE)
    def found(a, b, c):
        return min(a, b), max(a, b), min(a, b, c), max(c, b, a), min(a, 2), max(3, b)

    nan = float("nan")
    for a, b, c in product((1.0, -0.0, 0.0, nan, 7.5), (0.0, nan, -2.0), (3, -4)):
        assert repr(found(a, b, c)) == repr(tuple(map(float, found.py_func(a, b, c))))


def items(start, stop, step):
    count, total, last = 0, 0, -7
    for k in range(start, stop, step):
        if k == 5:
            continue
        for j in range(k):
            total += j * step
            if j > 3:
                break
        count, last = count + 1, k
    for k in range(start, stop):
        total += 10 * k
    for k in range(stop - 1, start - 1, -1):
        total -= 1000 * k
    return count, total, last


@compiled
def test_loops_run_as_often_as_python_says():
    kernel = numba.njit(types.UniTuple(types.int64, 3)(*[types.int64] * 3), **PIPELINE)(items)
    for given in product((-3, 0, 2, 7), (-4, 0, 3, 8, 9), (-5, -2, -1, 1, 2, 3, 11)):
        assert kernel(*given) == items(*given), given
    with pytest.raises(ValueError, match="arg 3 must not be zero"):
        kernel(0, 1, 0)


@helper
def root(x):
    if x < 0.0:
        raise ValueError("below 0")
    return math.sqrt(x) if x < 100.0 else None


def rooted(values, which):
    total = 0.0
    for x in values:
        found = root(x)
        if found is None:
            total += 1000.0
        else:
            total += found
    if which > 2:
        values = values[1:]
    while which > 0:
        values, which = values[: values.size - 1].copy(), which - 1
    return values, total


@compiled
def test_calls_that_raise_or_give_nothing_and_arguments_that_change_lose_no_memory():
    kernel = numba.njit(types.Tuple((types.float64[::1], types.float64))(types.float64[::1], types.int64), **PIPELINE)(
        rooted
    )
    values = np.array([4.0, 9.0, 400.0, 16.0, 1.0, 0.0])
    _nrt_python.memsys_enable_stats()
    before, kept = rtsys.get_allocation_stats(), sys.getrefcount(values)
    for which, size in [(0, 6), (1, 5), (3, 2)] * 20:
        found, total = kernel(values, which)
        assert (found.size, total) == (size, 1010.0)
        assert np.array_equal(found, values[which > 2 :][:size])
        del found
    after = rtsys.get_allocation_stats()
    assert after.alloc - before.alloc == after.free - before.free
    assert sys.getrefcount(values) == kept
    with pytest.raises(ValueError, match="below 0"):
        kernel(-values, 0)
