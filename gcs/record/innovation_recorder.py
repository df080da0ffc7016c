"""Recorder of the estimator's innovation tests, channel by channel."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from gcs.record.incomplete import IncompleteRecords
from gcs.record.tables import INNOVATION_COLUMNS, INNOVATIONS, Grid, TableWriter
from idc_controller.estimation.measurements import PAYLOAD, Channel

if TYPE_CHECKING:
    from idc_controller.estimation.estimator import Estimator
    from idc_controller.estimation.health.sensor_health import SensorHealth
    from idc_controller.estimation.measurements import Estimate, SensorKey

INTERVAL = 0.1
"""s, between rows."""
_DIGITS = 4


class InnovationRecorder(TableWriter):
    """Writes the largest test ratio of each channel since the row before, and the channel's state."""

    def __init__(self, run_dir: Path, incomplete: IncompleteRecords | None = None) -> None:
        super().__init__(run_dir / INNOVATIONS, INNOVATION_COLUMNS, incomplete)
        self._largest: dict[SensorKey, list[float]] = {}
        """Of pose and motion."""
        self._learnt: dict[SensorKey, float] = {}
        """Time of the last sample of each sensor that counts (s): one that is replayed counts once."""
        self._channels: list[tuple[SensorKey, Channel, str]] = []
        """All, with the cells that name them."""
        self._grid = Grid(INTERVAL)

    def record(self, estimator: Estimator, estimate: Estimate, time: float) -> None:
        """Take the tests of an ``estimate``, and write a row for each channel at team ``time`` (s), if it is due."""
        largest, learnt = self._largest, self._learnt
        for innovation in estimate.innovations:
            for key, ratios in zip(innovation.keys, innovation.test_ratios.tolist(), strict=True):
                if innovation.time <= learnt.get(key, -math.inf):
                    continue
                learnt[key] = innovation.time
                known = largest.setdefault(key, [math.nan, math.nan])
                for part in (0, 1):
                    if not ratios[part] <= known[part]:  # nan: none yet, or not tested
                        known[part] = known[part] if math.isnan(ratios[part]) else ratios[part]
        if self._grid.is_due(time):
            self._write_states(estimator, time)
            largest.clear()

    def _write_states(self, estimator: Estimator, time: float) -> None:
        self._channels = self._channels or [
            (key, channel, f"{'payload' if key[0] == PAYLOAD else f'vehicle {key[0] + 1}'},{channel.name}")
            for key in estimator.measurement_model.observations
            for channel in (Channel(*key, 0), Channel(*key, 1))
        ]
        states = dict.fromkeys(_isolated(estimator.health), "isolated")
        states |= dict.fromkeys(estimator.health.stuck_channels, "stuck")
        at, lines, largest = round(time, 6), [], self._largest
        for key, channel, cells in self._channels:
            ratio = largest[key][channel.part] if key in largest else math.nan
            state = (states and states.get(channel)) or ("rejected" if ratio > 1.0 else "ok")
            lines.append(f"{at!r},{cells},{round(ratio, _DIGITS)!r},{state}\n")
        self.append("".join(lines).encode())


def _isolated(health: SensorHealth) -> set[Channel]:
    """Return the channels that are isolated, alone or with their group."""
    isolated = set(health.isolation.isolated)
    for group, parts in health.isolated_groups.items():
        sources = [PAYLOAD] if group.of_payload else range(health.number_of_uavs)
        isolated |= {Channel(source, group.kind, part) for source in sources for part in (0, 1) if parts[part]}
    return isolated
