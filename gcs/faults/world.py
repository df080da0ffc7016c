"""Faults of the world: wind, a load that changes, and grippers that are stuck."""

from typing import Annotated

from gcs.config import SystemConfig
from gcs.config.tables import PAYLOAD_MASS_MIN, Vector
from gcs.faults.kind import FaultSettings, Problem, Vehicles, kind, names, parameter
from idc_controller.errors import ParameterError

ALL_GRIPPERS = 0


@kind("wind", "world", ("gust", "gusts", "turbulence", "wind_gust", "wind_gusts"), of_vehicles=False)
class Wind(FaultSettings):
    """Wind, the same everywhere, with gusts: first-order coloured noise. Drag on payload and UAVs is quadratic."""

    velocity: Annotated[Vector, parameter("steady part, direction of the air's motion, north-east-down", "m/s")]
    gust: Annotated[float, parameter("standard deviation north and east; half of it down", "m/s", ge=0.0, le=30.0)] = (
        0.0
    )
    gust_time: Annotated[float, parameter("correlation time of the gusts", "s", gt=0.0, le=100.0)] = 2.0
    rise: Annotated[float, parameter("time in which it rises, smoothly", "s", ge=0.0, le=1e3)] = 2.0

    def problem(self, system: SystemConfig, vehicles: Vehicles) -> Problem:
        """Refuse more than a hurricane."""
        return ("velocity", "more than 100 m/s") if max(map(abs, self.velocity)) > 100.0 else None


@kind(
    "payload_mass",
    "world",
    ("mass", "load", "weight", *names("payload load mass", "change step added removed weight release")),
    of_vehicles=False,
)
class PayloadMass(FaultSettings):
    """The payload is heavier or lighter at once, inertia in proportion, centre of mass where it was."""

    change: Annotated[float, parameter("what is added", "kg", ge=-1e3, le=1e3)]

    def problem(self, system: SystemConfig, vehicles: Vehicles) -> Problem:
        """Refuse a load that is nothing, or more than the team can carry."""
        true = system.true_parameters()
        mass = true.m_0 + self.change
        if mass < PAYLOAD_MASS_MIN:
            return "change", f"{mass:g} kg would be left of the payload: at least {PAYLOAD_MASS_MIN:g}"
        try:
            true.with_payload_mass(mass)
        except ParameterError as error:
            return "change", str(error)
        return None


@kind(
    "gripper_stuck",
    "world",
    ("gripper", *names("gripper winch cargo", "stuck jam jammed failure fail failed fault blocked")),
    of_vehicles=False,
)
class GripperStuck(FaultSettings):
    """A gripper acknowledges commands, and neither releases nor grabs its cargo."""

    gripper: Annotated[int, parameter("number of the gripper; 0: all", aliases="id number", ge=0, le=6)] = ALL_GRIPPERS

    def problem(self, system: SystemConfig, vehicles: Vehicles) -> Problem:
        """Refuse a gripper that the payload does not have."""
        grippers = [cargo.gripper for cargo in system.cargo]
        if not grippers:
            return "gripper", "the payload has none: [[cargo]] of the system file"
        if self.gripper not in (ALL_GRIPPERS, *grippers):
            return "gripper", f"the payload has no gripper {self.gripper}, only {', '.join(map(str, grippers))}"
        return None
