"""Compile options and array types shared by every numba kernel.

Batch kernels carry an explicit signature, so each is compiled exactly once;
a read-only array type accepts writable arrays as well. Scalar helpers carry
none: LLVM inlines them into the batch kernel that calls them.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba import njit, types
from numba.extending import register_jitable


def _source_fingerprint() -> str:
    """Hash of every toile source file: numba's own cache misses edits in callees in other files."""
    digest = hashlib.sha256(numba.__version__.encode())
    root = Path(__file__).resolve().parent.parent
    for folder in ("geometry", "collide", "remesh", "engine", "dressing", "studies"):
        for path in sorted((root / folder).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def kernel_cache_dir() -> Path:
    """Return the folder that holds the machine code of exactly these sources."""
    base = os.environ.get("TOILE_CACHE_DIR")
    root = Path(base) if base else Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "toile"
    return root / _source_fingerprint()


CACHE_DIR = Path(os.environ.get("NUMBA_CACHE_DIR") or kernel_cache_dir())
WARM = CACHE_DIR.is_dir()
"""True when these sources were compiled before on this machine."""
numba.config.CACHE_DIR = str(CACHE_DIR)

F64_1 = types.Array(types.float64, 1, "C", readonly=True)
F64_2 = types.Array(types.float64, 2, "C", readonly=True)
F64_3 = types.Array(types.float64, 3, "C", readonly=True)
I8_1 = types.Array(types.int8, 1, "C", readonly=True)
I32_1 = types.Array(types.int32, 1, "C", readonly=True)
I32_2 = types.Array(types.int32, 2, "C", readonly=True)
I64_1 = types.Array(types.int64, 1, "C", readonly=True)
BOOL_1 = types.Array(types.boolean, 1, "C", readonly=True)
OUT_F64_1 = types.Array(types.float64, 1, "C")
OUT_F64_2 = types.Array(types.float64, 2, "C")
OUT_F64_3 = types.Array(types.float64, 3, "C")
OUT_F64_4 = types.Array(types.float64, 4, "C")
OUT_I8_1 = types.Array(types.int8, 1, "C")
OUT_I32_1 = types.Array(types.int32, 1, "C")
OUT_I32_2 = types.Array(types.int32, 2, "C")
OUT_BOOL_1 = types.Array(types.boolean, 1, "C")


# What only costs compile time here: wrappers for C callers that do not exist, and numba's rewrites of array
# expressions, which scalar kernels do not have (6 % of all compile time).
LEAN = {"error_model": "numpy", "no_cfunc_wrapper": True, "no_rewrites": True}


def kernel(signature: Any) -> Any:
    """Compile a batch kernel for one signature, cached on disk."""
    return njit(signature, cache=True, nogil=True, **LEAN)


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
