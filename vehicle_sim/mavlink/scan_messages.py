"""The messages of a scan of the range sensor: its returns, and the one behind them that ends it."""

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.layout import LAYOUTS, Packed, PackedRun
from gcs.mavlink.services.aircraft import Built
from vehicle_sim.mavlink.report import VehicleReport
from vehicle_sim.mavlink.scan_kernels import nearest_by_sector
from vehicle_sim.world.range_sensor import RangeSample

_OBSTACLE_DISTANCE_3D = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D]
_OBSTACLE_DISTANCE = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE]
_UNKNOWN_OBSTACLE = 0xFFFF
_SECTORS, _NO_RETURN = 72, 0xFFFF


class ScanMessages:
    """The messages of the last scan, built once for all peers."""

    def __init__(self, report: VehicleReport) -> None:
        self._report = report
        self._built: tuple[RangeSample | None, Built, Built] = (None, (), ())
        """The scan that was built last, its returns, and its end."""

    def returns(self, now: float) -> Built:
        """The returns of the last scan, one a message."""
        return self._latest()[1]

    def end(self, now: float) -> Built:
        """The nearest return of each sector; it ends a scan, also one without returns."""
        return self._latest()[2]

    def _latest(self) -> tuple[RangeSample | None, Built, Built]:
        """Return the last scan with its messages; a failed sensor makes none."""
        scan = self._report.scan
        if scan is not self._built[0]:
            made = scan is not None and scan.works and scan.is_sent
            returns = self._points(scan) if scan is not None and made and len(scan.points) else ()
            self._built = scan, returns, (self._sectors(scan),) if scan is not None and made else ()
        return self._built

    def _points(self, scan: RangeSample) -> PackedRun:
        points = np.empty(len(scan.points), _OBSTACLE_DISTANCE_3D.dtype)
        points["time_boot_ms"] = self._report.time_boot_ms(scan.time)
        points["x"], points["y"], points["z"] = scan.points.T
        points["min_distance"], points["max_distance"] = scan.range_min, scan.reach
        points["obstacle_id"] = _UNKNOWN_OBSTACLE
        points["sensor_type"], points["frame"] = mavlink.MAV_DISTANCE_SENSOR_LASER, mavlink.MAV_FRAME_BODY_FRD
        return PackedRun(_OBSTACLE_DISTANCE_3D, points)

    def _sectors(self, scan: RangeSample) -> Packed:
        """The nearest return of each sector (cm), the first ahead, clockwise."""
        end = np.zeros(1, _OBSTACLE_DISTANCE.dtype)
        end["time_usec"] = self._report.time_boot_us(scan.time)
        end["distances"] = nearest_by_sector(scan.points, _SECTORS, _NO_RETURN)
        end["min_distance"], end["max_distance"] = (
            min(round(100.0 * distance), _NO_RETURN - 1) for distance in (scan.range_min, scan.reach)
        )
        end["sensor_type"], end["frame"] = mavlink.MAV_DISTANCE_SENSOR_LASER, mavlink.MAV_FRAME_BODY_FRD
        end["increment"] = 360 // _SECTORS
        return _OBSTACLE_DISTANCE, end.tobytes()
