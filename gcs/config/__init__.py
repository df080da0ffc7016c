"""Configuration: the system's parameters, read strictly from TOML into frozen dataclasses."""

from gcs.config.system import SystemConfig, read_system
from gcs.config.tables import MotionConfig, RangeSensorConfig, UavConfig
from gcs.config.validate import UnusableFile

__all__ = ["MotionConfig", "RangeSensorConfig", "SystemConfig", "UavConfig", "UnusableFile", "read_system"]
