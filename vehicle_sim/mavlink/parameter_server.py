"""The MAVLink parameter protocol of a vehicle, in PX4's byte-wise flavour."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.common as mavlink

from gcs.mavlink import px4
from vehicle_sim.autopilot.parameter_table import Parameter, ParameterRefusalError, ParameterTable
from vehicle_sim.mavlink.control_owner import ControlOwner, Sender
from vehicle_sim.mavlink.peers import Peer


class ParameterServer:
    """PARAM_REQUEST_READ, PARAM_REQUEST_LIST and PARAM_SET. A refused PARAM_SET is answered with the value kept."""

    def __init__(self, table: ParameterTable, owner: ControlOwner) -> None:
        self._table = table
        self._owner = owner
        self.handlers: dict[int, Callable[[Any, Sender, Peer, float], None]] = {
            mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ: self._on_read,
            mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: self._on_list,
            mavlink.MAVLINK_MSG_ID_PARAM_SET: self._on_set,
        }

    def _on_read(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        if message.param_index >= 0:
            parameter = self._table.by_index(message.param_index)
        else:
            parameter = self._table.by_name(message.param_id)
        if parameter is not None:
            peer.reply(self._value(parameter))

    def _on_list(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        for index in range(len(self._table)):
            parameter = self._table.by_index(index)
            if parameter is not None:
                peer.reply(self._value(parameter))

    def _on_set(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        name = message.param_id
        if self._owner.is_stranger(sender, now):
            peer.tell(f"{name} denied: another ground is in control")
        else:
            try:
                self._table.set_from_wire(name, message.param_value, message.param_type)
            except ParameterRefusalError as error:
                peer.tell(str(error))
        parameter = self._table.by_name(name)
        if parameter is not None:
            peer.reply(self._value(parameter))

    def _value(self, parameter: Parameter) -> Any:
        return mavlink.MAVLink_param_value_message(
            parameter.name.encode(),
            px4.parameter_to_wire(parameter.value, parameter.type),
            parameter.type,
            len(self._table),
            self._table.index_of(parameter.name),
        )
