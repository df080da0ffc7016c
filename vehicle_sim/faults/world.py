"""Faults of the world: wind, by a simple model of drag, a load that changes, and grippers that are stuck.

Drag is quadratic in the air's velocity against the body, along that velocity, at the centre of mass:
F = 1/2 rho c_d A |u| u. The payload's area across the wind is made of its silhouettes along its
axes, as of a box; a UAV's product c_d A is the same from all sides. The wind acts on neither thrust, torques nor links.
Without a wind fault there is no air at all.
"""

import math
from collections.abc import Sequence

from gcs.config.tables import AirSettings
from gcs.faults import world as kinds
from idc_controller.rotations_float import Vector, into_body
from vehicle_sim.faults.active import WORLD, ActiveFault
from vehicle_sim.world.free_world import FreeWorld
from vehicle_sim.world.world import World
from vehicle_sim.world.world_state import WorldState

Forces = tuple[Vector | None, Sequence[Vector]]
"""Forces on the payload, if there is one, and on each UAV, at the centres of mass, north-east-down (N)."""


class Wind:
    """The air's velocity by one fault."""

    def __init__(self, fault: ActiveFault) -> None:
        self.fault = fault
        self._generator = fault.generator(WORLD)
        self._gust = [0.0, 0.0, 0.0]
        self._occurrence = -1
        self._elapsed = 0.0

    def velocity(self, now: float) -> Vector | None:
        """Return the velocity in the world (m/s); None while the fault is not active. Times must not decrease."""
        moment = self.fault.schedule.at(now)
        if moment is None:
            return None
        settings: kinds.Wind = self.fault.settings
        if moment.occurrence != self._occurrence:
            self._occurrence, self._elapsed, self._gust = moment.occurrence, moment.elapsed, [0.0, 0.0, 0.0]
        if settings.gust > 0.0:
            # First-order noise, exact for any step: its spectrum is that of Dryden's longitudinal gusts.
            keep = math.exp(-(moment.elapsed - self._elapsed) / settings.gust_time)
            new = settings.gust * math.sqrt(1.0 - keep * keep)
            shares = (new, new, 0.5 * new)
            normals = self._generator.standard_normal(3).tolist()
            self._gust = [keep * g + s * n for g, s, n in zip(self._gust, shares, normals, strict=True)]
        self._elapsed = moment.elapsed
        risen = 1.0
        if moment.elapsed < settings.rise:
            risen = 0.5 - 0.5 * math.cos(math.pi * moment.elapsed / settings.rise)
        x, y, z = (risen * (v + g) for v, g in zip(settings.velocity, self._gust, strict=True))
        return x, y, z


class WorldFaults:
    """All faults of the world of one flight."""

    def __init__(self, faults: Sequence[ActiveFault], air: AirSettings = AirSettings()) -> None:
        self._air = air
        self._winds = [Wind(fault) for fault in faults if isinstance(fault.settings, kinds.Wind)]
        self._loads = [fault for fault in faults if isinstance(fault.settings, kinds.PayloadMass)]
        self._stuck = [fault for fault in faults if isinstance(fault.settings, kinds.GripperStuck)]
        self._change = 0.0

    def act(self, world: World | FreeWorld, now: float) -> Forces | None:
        """Set the load, and return the drag on payload and UAVs (N); None: no air moves."""
        if self._loads and isinstance(world, World):
            self._set_load(world, now)
        air = None
        for wind in self._winds:
            velocity = wind.velocity(now)
            if velocity is not None:
                wind.fault.seen += 1
                wind.fault.disturbed += 1
                air = velocity if air is None else (air[0] + velocity[0], air[1] + velocity[1], air[2] + velocity[2])
        return None if air is None else _drag(world, self._air, air)

    def _set_load(self, world: World, now: float) -> None:
        total = 0.0
        for fault in self._loads:
            if fault.schedule.at(now) is not None:
                fault.seen += 1
                fault.disturbed += 1
                total += fault.settings.change
        if total != self._change:
            self._change = total
            world.add_payload_mass("faults", total)

    def is_stuck(self, gripper: int, now: float) -> bool:
        """Return whether a gripper that is commanded ``now`` (s) is stuck."""
        stuck = False
        for fault in self._stuck:
            if fault.settings.gripper in (kinds.ALL_GRIPPERS, gripper) and fault.schedule.at(now) is not None:
                fault.seen += 1
                fault.disturbed += 1
                stuck = True
        return stuck


def _drag(world: World | FreeWorld, settings: AirSettings, air: Vector) -> Forces:
    state = world.state()
    payload = None
    if isinstance(world, World) and isinstance(state, WorldState):
        relative = _minus(air, state.payload_velocity_in_world)
        area_x, area_y, area_z = world.parameters.payload.areas.tolist()
        # |u| times the area across u: of a box, the sum over its faces of their share in u.
        x, y, z = into_body(state.payload_quaternion, relative)
        area_times_speed = abs(x) * area_x + abs(y) * area_y + abs(z) * area_z
        payload = _times(0.5 * settings.density * settings.payload_drag * area_times_speed, relative)
    uavs = []
    for uav in state.uavs:
        relative = _minus(air, uav.velocity_in_world)
        uavs.append(_times(0.5 * settings.density * settings.uav_drag_area * math.hypot(*relative), relative))
    return payload, uavs


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _times(factor: float, a: Vector) -> Vector:
    return factor * a[0], factor * a[1], factor * a[2]
