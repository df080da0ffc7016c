"""The MAVLink parameter protocol of a vehicle, in PX4's byte-wise flavour."""

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from vehicle_sim.autopilot.parameter_table import Parameter, ParameterRefusalError, ParameterTable
from vehicle_sim.mavlink.control_owner import ControlOwner
from vehicle_sim.mavlink.dispatcher import Dispatcher, Request


class ParameterServer:
    """PARAM_REQUEST_READ, PARAM_REQUEST_LIST and PARAM_SET. A refused PARAM_SET is answered with the value kept."""

    def __init__(self, table: ParameterTable, owner: ControlOwner) -> None:
        self._table = table
        self._owner = owner

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        dispatcher.register(mavlink.MAVLink_param_request_read_message, self._on_read)
        dispatcher.register(mavlink.MAVLink_param_request_list_message, self._on_list)
        dispatcher.register(mavlink.MAVLink_param_set_message, self._on_set)

    def _on_read(self, message: mavlink.MAVLink_param_request_read_message, request: Request) -> None:
        if message.param_index >= 0:
            self._send(self._table.by_index(message.param_index), request)
        else:
            self._send(self._table.by_name(message.param_id), request)

    def _on_list(self, message: mavlink.MAVLink_param_request_list_message, request: Request) -> None:
        for index in range(len(self._table)):
            self._send(self._table.by_index(index), request)

    def _on_set(self, message: mavlink.MAVLink_param_set_message, request: Request) -> None:
        name = message.param_id
        if self._owner.is_stranger(request.sender, request.now):
            request.peer.send_statustext(f"{name} denied: another ground is in control")
        else:
            try:
                self._table.set_from_wire(name, message.param_value, message.param_type)
            except ParameterRefusalError as error:
                request.peer.send_statustext(str(error))
        self._send(self._table.by_name(name), request)

    def _send(self, parameter: Parameter | None, request: Request) -> None:
        """Send the value of a parameter; nothing of one that does not exist."""
        if parameter is None:
            return
        value = px4.parameter_to_wire(parameter.value, parameter.type)
        count, index = len(self._table), self._table.index_of(parameter.name)
        request.peer.reply(
            mavlink.MAVLink_param_value_message(parameter.name.encode(), value, parameter.type, count, index)
        )
