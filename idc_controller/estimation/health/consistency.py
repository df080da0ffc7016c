"""Which measurements disagree with all others: tests on each source's innovations over time.

Innovations whitened by their covariance are, of a sound filter, independent and normal with variance 1. Running means
over about a second show what no single sample does: a bias far below the outlier gate, or noise that is too large.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from idc_controller.estimation.measurements import PAYLOAD, Attitude

Array = NDArray[np.float64]
Key = tuple[int, type]
Refusal = tuple[int, str]

RARE = 1e-10
"""Probability with which a sound channel is taken for a bad one at a sample; an hour has about 1e6 samples."""
SHARE = 0.04
"""Of one sample in the running means: about a second of samples."""
REFUSALS, WITHIN = 3, 1.0
"""Single refusals happen; so many of one channel within such a time (s) do not."""
MANOEUVRE = 2.5
"""Of a UAV's attitude: how much larger than it should be its innovations' variance may be, and all that follows of it.

When set-points change quickly the attitude loop is not quite what the model says, and the innovations of all UAVs grow
together for a second: to 2.9 times their variance in quick manoeuvres, where the limit is 4.5, with two refusals in a
second, where it is 8. Manoeuvres that are harder than that are for the caller to leave out.
"""


@dataclass
class _Channel:
    size: int
    mean: Array
    square: float = 1.0
    time: float = -np.inf
    refusals: deque[float] = field(default_factory=deque)


class Consistency:
    """Learns from the innovations of one moment after the other, and says which channels are not sound."""

    def __init__(self, gate_probability: float) -> None:
        """``gate_probability`` of the outlier gate: beyond it a sample counts as one at the gate."""
        self._channels: dict[tuple[Key, int], _Channel] = {}
        """By what is measured, and how many numbers of it: now and then only the half of it comes."""
        sizes = np.arange(1, 7)
        kept = (2.0 - SHARE) / SHARE
        # Variance of a running mean is 1 / kept; its square sum times kept is chi-squared with ``size`` degrees of
        # freedom, and the running mean square like one of kept * size of them.
        self._gates = dict(zip(sizes.tolist(), chi2.ppf(gate_probability, sizes).tolist(), strict=True))
        self._mean_limits = dict(zip(sizes.tolist(), (chi2.isf(RARE, sizes) / kept).tolist(), strict=True))
        freedom = kept * sizes
        self._square_limits = dict(zip(sizes.tolist(), (chi2.isf(RARE, freedom) / freedom).tolist(), strict=True))

    def learn(self, time: float, keys: Sequence[Key], white: Sequence[Array], refused: Sequence[Refusal]) -> None:
        """From the moment ``time`` (s): whitened innovations ``white`` of the channels ``keys``.

        ``refused``: source and kind of those that the gate kept out. A moment that is told again, because something of
        it came late, counts only for what is new in it.
        """
        for key, innovation in zip(keys, white, strict=True):
            size = len(innovation)
            channel = self._channels.get((key, size))
            if channel is None:
                channel = self._channels[key, size] = _Channel(size, np.zeros(size))
            if time <= channel.time:
                continue
            channel.time = time
            gate = self._gates[size]
            bounded = np.nan_to_num(np.clip(innovation, -np.sqrt(gate), np.sqrt(gate)))
            channel.mean = channel.mean + SHARE * (bounded - channel.mean)
            square = min(float(bounded @ bounded), gate) / size
            channel.square += SHARE * (square - channel.square)
            if (key[0], key[1].__name__) in refused:
                channel.refusals.append(time)

    def forget_attitudes(self) -> None:
        """What was learnt of the UAVs' attitudes does not count."""
        for channel in tuple(self._channels):
            (source, kind), _ = channel
            if source != PAYLOAD and kind is Attitude:
                del self._channels[channel]

    def complaints(self, time: float) -> dict[Key, list[str]]:
        """What is wrong with channels at ``time`` (s): ``refused``, ``disagrees`` (biased) or ``noisy``."""
        found: dict[Key, list[str]] = defaultdict(list)
        for (key, _), channel in self._channels.items():
            while channel.refusals and time - channel.refusals[0] > WITHIN:
                channel.refusals.popleft()
            slack = MANOEUVRE if key[0] != PAYLOAD and key[1] is Attitude else 1.0
            if len(channel.refusals) >= slack * REFUSALS:
                found[key].append("refused")
            if float(channel.mean @ channel.mean) > slack * self._mean_limits[channel.size]:
                found[key].append("disagrees")
            if channel.square > slack * self._square_limits[channel.size]:
                found[key].append("noisy")
        return dict(found)
