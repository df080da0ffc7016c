"""The kinds of fault and their parameters: what a mission may name. The simulator has their effects."""

from gcs.faults.kind import Direction, Kind
from gcs.faults.kinds import KINDS, read_settings

__all__ = ["KINDS", "Direction", "Kind", "read_settings"]
