"""Memory of solvers whose sums depend on where their largest blocks begin."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager

_LARGE = 128 * 1024  # bytes, from which on glibc gives a block pages of its own until blocks of more have been freed
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt
_LARGEST_THRESHOLD = 32 * 1024 * 1024  # bytes, up to which glibc raises the threshold by itself, until it is set
_IS_MAPPED = 2  # in the size of a block, which stands before it


@contextmanager
def pages_of_their_own() -> Iterator[None]:
    """Let each block that is allocated within, of 128 KiB or more, begin at the same place in a page of its own.

    Nothing is done where the C library is not glibc.
    """
    c = ctypes.CDLL(None)
    if not hasattr(c, "mallopt") or not hasattr(c, "gnu_get_libc_version"):
        yield
        return
    c.malloc.restype, c.malloc.argtypes, c.free.argtypes = ctypes.c_void_p, [ctypes.c_size_t], [ctypes.c_void_p]
    c.mallopt(_MMAP_THRESHOLD, _LARGE)
    taken: list[int] = []  # what is free between the blocks of others
    while not _is_mapped(block := c.malloc(_LARGE)):
        taken.append(block)
    c.free(block)
    try:
        yield
    finally:
        for block in taken:
            c.free(block)
        # With pages of their own, the arrays of a flight would have each page cleared at every use.
        c.mallopt(_MMAP_THRESHOLD, _LARGEST_THRESHOLD)
        c.mallopt(_TRIM_THRESHOLD, 2 * _LARGEST_THRESHOLD)


def _is_mapped(block: int) -> bool:
    size = ctypes.c_size_t.from_address(block - ctypes.sizeof(ctypes.c_size_t)).value
    return bool(size & _IS_MAPPED)
