# mypy: ignore-errors
"""Single machine instructions that numba has no function for. All give the same bits on every machine."""

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from sceneql.compiled.kernels import inlined

UNCOMPILED = numba.config.DISABLE_JIT
WIDEST = '"prefer-vector-width"="512"'


@intrinsic
def _fma(typing, a, b, c):
    return a(a, a, a), lambda context, builder, signature, given: builder.fma(*given)


@intrinsic
def _bits(typing, x):
    return types.int64(types.float64), lambda context, builder, signature, a: builder.bitcast(a[0], ir.IntType(64))


@intrinsic
def _from_bits(typing, x):
    return types.float64(types.int64), lambda context, builder, signature, a: builder.bitcast(a[0], ir.DoubleType())


@intrinsic
def _widest(typing):
    def code(context, builder, signature, arguments):
        # llvmlite has no function attributes with values, but prints every member of the set as it is.
        set.add(builder.function.attributes, WIDEST)
        return context.get_dummy_value()

    return types.none(), code


@intrinsic
def _always_inlined(typing):
    def code(context, builder, signature, arguments):
        builder.function.attributes.add("alwaysinline")
        return context.get_dummy_value()

    return types.none(), code


def _fma_in_python(a, b, c):
    return type(a)(np.longdouble(a) * np.longdouble(b) + np.longdouble(c))


fma = _fma_in_python if UNCOMPILED else _fma
"""a b + c, rounded once."""
bits = (lambda x: int(np.float64(x).view(np.int64))) if UNCOMPILED else _bits
"""The 64 bits of a float64 as an integer."""
from_bits = (lambda n: float(np.int64(n).view(np.float64))) if UNCOMPILED else _from_bits
"""The float64 of 64 bits."""
widest = (lambda: None) if UNCOMPILED else _widest
"""Ask LLVM for its widest vectors in the calling kernel, where it would take narrower ones. The bits do not change."""
always_inlined = (lambda: None) if UNCOMPILED else _always_inlined
"""Inline the calling helper into its callers whatever its size: loops with calls in them are not vectorized."""


@inlined
def inverse_root(s):
    """s^(-1/2) for s > 0, to some 1e-16: a first guess by the exponent (Lomont 2003), refined twice by polynomials."""
    r = from_bits(0x5FE6AB50C7B537A9 - (bits(s) >> 1))
    c = s * (r * r)
    r = r * fma(fma(0.39409475, c, -1.28885265), c, 1.89474086)
    e = fma(-s, r * r, 1.0)
    return r * fma(fma(fma(0.3125, e, 0.375), e, 0.5), e, 1.0)
