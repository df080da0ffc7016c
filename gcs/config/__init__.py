"""Configuration: the system's parameters, read strictly from TOML into frozen dataclasses."""

from gcs.config.system import SystemConfig, read_system
from gcs.config.tables import (
    MotionConfig,
    PayloadConfig,
    RangeSensorConfig,
    RatesConfig,
    SensorsConfig,
    TeamConfig,
    UavConfig,
    WorldConfig,
)
from gcs.config.validate import UnusableFile

__all__ = [
    "MotionConfig",
    "PayloadConfig",
    "RangeSensorConfig",
    "RatesConfig",
    "SensorsConfig",
    "SystemConfig",
    "TeamConfig",
    "UavConfig",
    "UnusableFile",
    "WorldConfig",
    "read_system",
]
