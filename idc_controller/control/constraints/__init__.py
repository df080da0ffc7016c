"""The constraints of the MPC, one a file; :func:`state_constraints` is where a new one is registered."""

from idc_controller.control.constraints.constraint import StateConstraint
from idc_controller.control.constraints.lowest_payload import LowestPayload
from idc_controller.control.constraints.payload_tilt import PayloadTilt
from idc_controller.control.constraints.uav_separation import UavSeparation
from idc_controller.control.settings import MpcSettings
from idc_controller.model.linear import LinearModel

__all__ = ["state_constraints"]


def state_constraints(model: LinearModel, settings: MpcSettings) -> tuple[StateConstraint, ...]:
    """Return the soft constraints on the state, in the order of their rows at a stage."""
    return (
        PayloadTilt(model, settings),
        LowestPayload(model, settings),
        UavSeparation(model, settings),
    )
