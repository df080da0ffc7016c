"""Configuration: the system's parameters, read strictly from TOML into frozen dataclasses."""

from gcs.config.problems import UnusableFile
from gcs.config.system import (
    ControllerConfig,
    MotionConfig,
    PayloadConfig,
    RangeSensorConfig,
    RatesConfig,
    SensorsConfig,
    SystemConfig,
    TeamConfig,
    UavConfig,
    WeightsConfig,
    WorldConfig,
    default_system_path,
    read_system,
)

__all__ = [
    "ControllerConfig",
    "MotionConfig",
    "PayloadConfig",
    "RangeSensorConfig",
    "RatesConfig",
    "SensorsConfig",
    "SystemConfig",
    "TeamConfig",
    "UavConfig",
    "UnusableFile",
    "WeightsConfig",
    "WorldConfig",
    "default_system_path",
    "read_system",
]
