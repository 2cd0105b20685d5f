"""What the compilation of kernels leaves out is not missed."""

import gc
import math

import numba
import numpy as np
import pytest
from numba import types

from sceneql.compiling import collecting_later
from sceneql.kernels import HELPER, KernelCompiler

helper = numba.njit(**HELPER)


@helper
def larger(a, b):
    return max(a, b)


@helper
def norm(values):
    total = 0.0
    for k in range(len(values)):
        total += larger(values[k], -values[k]) ** 2
    return math.sqrt(total)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_helpers_of_helpers_reach_the_machine_code_of_the_kernel_that_calls_them():
    kernel = numba.njit(types.float64(types.float64[::1]), pipeline_class=KernelCompiler)(lambda v: norm(v) + norm(-v))
    values = np.random.default_rng(1).normal(size=100)
    assert kernel(values) == pytest.approx(2.0 * np.linalg.norm(values), rel=1e-14)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_a_helper_refuses_to_be_called_from_python():
    kernel = numba.njit(types.float64(types.float64[::1]), pipeline_class=KernelCompiler)(lambda v: norm(v))
    assert kernel(np.ones(4)) == 2.0
    with pytest.raises(KeyError, match="norm is for kernels only"):
        norm(np.ones(4))


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_numbers_of_another_type_get_another_signature():
    of = {}
    for kind in (types.int64, types.float64, types.float32):
        kernel = numba.njit((kind, kind), pipeline_class=KernelCompiler)(lambda a, b: larger(a, b) * b + a)
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
