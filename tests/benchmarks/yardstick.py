"""CPU time in yardsticks: the time of one dense 60 x 60 solve, measured on the same machine at the same moment.

Ratios of CPU times travel between machines, and other work on the machine disturbs both sides alike; times do not.
"""

import statistics
import time
from collections.abc import Callable

import numpy as np

_A = np.random.default_rng(1).standard_normal((60, 60))
_SOLVES = 5


def cpu_seconds(function: Callable[[], object], repetitions: int = 1) -> float:
    """Return the CPU time of this process for one call (s)."""
    begin = time.process_time()
    for _ in range(repetitions):
        function()
    return (time.process_time() - begin) / repetitions


def yardstick() -> float:
    """Return the CPU time of one solve now (s)."""
    return cpu_seconds(lambda: np.linalg.solve(_A, _A), _SOLVES)


def in_yardsticks(function: Callable[[], object], repetitions: int, rounds: int = 20) -> float:
    """Return the median, over rounds, of the CPU time of one call; call and yardstick take turns."""
    return statistics.median(cpu_seconds(function, max(1, repetitions // rounds)) / yardstick() for _ in range(rounds))
