"""Recorder of the planned path and of the stop plan of the same moment."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gcs.record.incomplete import IncompleteRecords
from gcs.record.tables import HORIZON, HORIZON_COLUMNS, Grid, TableWriter

if TYPE_CHECKING:
    from idc_controller.parameters import SystemParameters
    from idc_controller.trajectory.flatness import PayloadTrajectory
    from idc_controller.trajectory.integrator_chain import Chain
    from idc_controller.trajectory.stop_plan import StopPlan

INTERVAL = 0.2
"""s, between the moments that are recorded."""
EVERY = 3
"""Stages of the safety filter's horizon from one recorded step to the next."""
_DIGITS = 3  # mm


class HorizonRecorder(TableWriter):
    """Writes the payload's path over the safety filter's horizon, and to rest by the stop plan."""

    def __init__(self, run_dir: Path, incomplete: IncompleteRecords | None = None) -> None:
        super().__init__(run_dir / HORIZON, HORIZON_COLUMNS, incomplete)
        self._grid = Grid(INTERVAL)

    def record(
        self, time: float, trajectory: PayloadTrajectory, stop: StopPlan, chain: Chain, parameters: SystemParameters
    ) -> None:
        """Record both from ``time`` (s) on, if they are due.

        Args:
            time: from which on the plan holds, and at which the stop plan starts (s).
            trajectory: the plan.
            stop: the stop plan.
            chain: stages of the safety filter's horizon.
            parameters: of the system.
        """
        if not self._grid.is_due(time):
            return
        steps = range(0, chain.stages + 1, EVERY)
        plan = trajectory.derivatives(time + chain.period * np.array(steps), 0)[0]
        to_rest = range(0, math.ceil(stop.duration / chain.period / EVERY) * EVERY + 1, EVERY)
        stopping = stop.payload_positions(parameters, chain.period * np.array(to_rest))
        at = round(time, 6)
        self.write_numbers(
            *[
                (at, kind, step, *place)
                for kind, stages, path in (("plan", steps, plan), ("stop", to_rest, stopping))
                for step, place in zip(stages, path.round(_DIGITS).tolist(), strict=True)
            ]
        )
