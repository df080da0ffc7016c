"""Quadratic programs: one statement of the problem, one file for each solver."""

import sys

# proxsuite takes the build for the newest instructions of the processor, and each sums in an order of its own: without
# the one for AVX-512 it is the same build on all processors with AVX2.
sys.modules.setdefault("proxsuite.proxsuite_pywrap_avx512", None)  # type: ignore[arg-type]
