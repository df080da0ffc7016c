"""The MPC's bandwidth by the age of what its set-points follow from (docs/link-margin.md).

Set-points that act a round trip after the newest measurement leave less margin for a delay that is not known of: the
latency that has just changed, or a set-point that is lost. The loop at hover needs no bandwidth to be stable, so beyond
an age it gets less.
"""

from idc_controller.arrays import Array
from idc_controller.control.mpc import ModelPredictiveController, TrackingOutput
from idc_controller.control.settings import MpcSettings
from idc_controller.model.linear import LinearModel
from idc_controller.trajectory.flatness import FlatReference


class ScheduledMpc:
    """Two MPCs of one model. :meth:`track` once a control period."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        self.horizon = settings.tuning.horizon
        self.by_age = ModelPredictiveController(model, settings), ModelPredictiveController(model, settings.late)
        """The MPC of the settings, and the slower one."""
        self._late_age, self._memory = settings.late_age, round(settings.late_memory / settings.period)
        self._late_steps = 0
        """Steps for which the lower bandwidth is left."""

    def track(self, error: Array, reference: FlatReference, age: float) -> TrackingOutput:
        """Set-points less the reference's, see :class:`~idc_controller.control.mpc.Tracker`."""
        self._late_steps = self._memory if age > self._late_age else max(self._late_steps - 1, 0)
        return self.by_age[self._late_steps > 0].track(error, reference)
