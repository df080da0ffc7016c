"""Faults of timing: rates, clocks and stamps, and a ground that hangs."""

from typing import Annotated

from gcs.faults.kind import FaultSettings, kind, names, parameter


@kind("low_rate", "timing", ("half_rate", *names("low reduced", "rate rates")), direction="telemetry")
class LowRate(FaultSettings):
    """Of the stream of measurements (telemetry) or of set-points (command), only an even share arrives."""

    share: Annotated[float, parameter("of the messages that arrive; 0.5: half rate", gt=0.0, le=1.0)] = 0.5


@kind("clock_skew", "timing", names("clock time", "skew drift rate speed"))
class ClockSkew(FaultSettings):
    """A vehicle's clock runs fast or slow; the error remains when the fault ends."""

    rate: Annotated[float, parameter("seconds gained per second", "s/s", ge=-0.5, le=0.5)]


@kind("clock_step", "timing", names("clock time", "step jump offset shift bias error"))
class ClockStep(FaultSettings):
    """A vehicle's clock is off by a constant; the offset ends with the fault."""

    step: Annotated[float, parameter("offset, positive: ahead", "s", ge=-1e6, le=1e6)]


@kind("stale_stamps", "timing", names("stale old late", "data stamps timestamps time_stamps measurements"))
class StaleStamps(FaultSettings):
    """Measurements are reported with the stamps of an earlier time."""

    age: Annotated[float, parameter("difference", "s", gt=0.0, le=1e3)]


@kind("stamp_wrap", "timing", names("stamp timestamp clock time", "wrap wraparound overflow rollover"))
class StampWrap(FaultSettings):
    """A vehicle's clock is set to just before its stamps (32 bits of ms) overflow, and then they do."""

    lead: Annotated[float, parameter("from the start of the fault to the overflow", "s", ge=0.0, le=1e6)] = 1.0


@kind(
    "ground_hang",
    "timing",
    (*names("gcs ground_station", "hang freeze"), *names("setpoint setpoints offboard", "loss lost")),
)
class GroundHang(FaultSettings):
    """Of the ground's messages only the heartbeat arrives, as if its program hung."""
