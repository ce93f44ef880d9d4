"""Compile options and array types shared by every numba kernel.

Batch kernels carry an explicit signature, so each is compiled exactly once;
a read-only array type accepts writable arrays as well. Scalar helpers carry
none: LLVM inlines them into the batch kernel that calls them.
"""

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numba import njit, types
from numba.extending import register_jitable

from toile.geometry.kernel_cache import CACHE_DIR as CACHE_DIR
from toile.geometry.kernel_cache import WARM as WARM
from toile.geometry.kernel_cache import KernelCache

F64_1 = types.Array(types.float64, 1, "C", readonly=True)
F64_2 = types.Array(types.float64, 2, "C", readonly=True)
F64_3 = types.Array(types.float64, 3, "C", readonly=True)
I8_1 = types.Array(types.int8, 1, "C", readonly=True)
I32_1 = types.Array(types.int32, 1, "C", readonly=True)
I32_2 = types.Array(types.int32, 2, "C", readonly=True)
I64_1 = types.Array(types.int64, 1, "C", readonly=True)
BOOL_1 = types.Array(types.boolean, 1, "C", readonly=True)
BOOL_3 = types.Array(types.boolean, 3, "C", readonly=True)
OUT_F64_1 = types.Array(types.float64, 1, "C")
OUT_F64_2 = types.Array(types.float64, 2, "C")
OUT_F64_3 = types.Array(types.float64, 3, "C")
OUT_F64_4 = types.Array(types.float64, 4, "C")
OUT_I8_1 = types.Array(types.int8, 1, "C")
OUT_I32_1 = types.Array(types.int32, 1, "C")
OUT_I32_2 = types.Array(types.int32, 2, "C")
OUT_BOOL_1 = types.Array(types.boolean, 1, "C")
OUT_BOOL_3 = types.Array(types.boolean, 3, "C")


# What only costs compile time here: wrappers for C callers that do not exist, and numba's rewrites of array
# expressions, which scalar kernels do not have (6 % of all compile time).
LEAN = {"error_model": "numpy", "no_cfunc_wrapper": True, "no_rewrites": True}


def kernel(signature: Any) -> Any:
    """Compile a batch kernel for one signature, or load it from disk; see kernel_cache.py."""

    def compile_kernel(function: Callable[..., Any]) -> Any:
        compiled = njit(nogil=True, **LEAN)(function)
        if not numba.config.DISABLE_JIT:
            # As `njit(signature, cache=True)` does, but in toile's own folder.
            compiled._cache = KernelCache(function)
            compiled.compile(signature)
            compiled.disable_compile()
        return compiled

    return compile_kernel


def packed_kernel(signature: Any) -> Any:
    """Compile a batch kernel as `kernel` does, with like sums in straight code done as one (LLVM's SLP).

    The digits stay the same. For sums that grow in loops, from neighbours in memory: elsewhere it costs time.
    """
    compile_kernel = kernel(signature)

    def compile_packed(function: Callable[..., Any]) -> Any:
        before = numba.config.SLP_VECTORIZE
        numba.config.SLP_VECTORIZE = 1
        try:
            return compile_kernel(function)
        finally:
            numba.config.SLP_VECTORIZE = before

    return compile_packed


unsigned = np.uintp
"""Type of an index in innermost loops: numba asks of a signed one whether it counts from the end. That took a
quarter of the time of a matrix product and four fifths of a band Cholesky factor's, which was not vectorised.
Its sum with a signed one would be a floating-point number."""

helper = register_jitable(**LEAN, no_cpython_wrapper=True)
"""Decorator of scalar helpers that batch kernels call.

From Python they run as they are written. Machine code for such calls, and wrappers around it, would take a
tenth of all compile time.
"""
