"""Limits of the motion along a curve, and whether a mission's curve keeps them."""

from gcs.config.tables import MotionConfig
from gcs.errors import UnusableInput
from gcs.mission.model import Lissajous, Mission
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.lissajous_curve import LissajousCurve, check_full_rate
from idc_controller.trajectory.settings import Limits


def check_curve(mission: Mission) -> None:
    """Raise :class:`UnusableInput` for a figure eight that is faster than the limits of its curve."""
    figure = mission.reference
    if isinstance(figure, Lissajous):
        curve = LissajousCurve(figure.amplitude, down=-figure.altitude)
        try:
            check_full_rate(curve, figure.angular_frequency, curve_limits(mission.system.motion))
        except TrajectoryError as error:
            raise UnusableInput(f"{mission.path}: table [reference]: angular_frequency: {error}") from None


def curve_limits(motion: MotionConfig) -> Limits:
    """Return the limits of the motion along a curve."""
    return Limits(motion.curve_speed, motion.curve_acceleration, motion.curve_jerk, motion.curve_snap)
