"""Synthetic results of obstacle scenarios."""

from gcs.campaign.result import Result

FIGURES = {
    "outcome": "completed", "clearance_min_m": 0.6, "tilt_max_deg": 2.0, "uav_separation_min_m": 0.9, "contacts": 0,
    "arrival_s": 30.0, "nominal_arrival_s": 28.0, "delay_s": 2.0, "wall_s": 1.0, "position_rmse_m": 0.4,
}  # fmt: skip


def result_of(**figures):
    """A flight that passed, but for the ``figures``."""
    return Result(**(FIGURES | figures))
