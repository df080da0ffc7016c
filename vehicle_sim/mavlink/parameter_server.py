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
            parameter = self._table.by_index(message.param_index)
        else:
            parameter = self._table.by_name(message.param_id)
        if parameter is not None:
            request.peer.reply(self._value(parameter))

    def _on_list(self, message: mavlink.MAVLink_param_request_list_message, request: Request) -> None:
        for index in range(len(self._table)):
            parameter = self._table.by_index(index)
            if parameter is not None:
                request.peer.reply(self._value(parameter))

    def _on_set(self, message: mavlink.MAVLink_param_set_message, request: Request) -> None:
        name = message.param_id
        if self._owner.is_stranger(request.sender, request.now):
            request.peer.send_statustext(f"{name} denied: another ground is in control")
        else:
            try:
                self._table.set_from_wire(name, message.param_value, message.param_type)
            except ParameterRefusalError as error:
                request.peer.send_statustext(str(error))
        parameter = self._table.by_name(name)
        if parameter is not None:
            request.peer.reply(self._value(parameter))

    def _value(self, parameter: Parameter) -> mavlink.MAVLink_param_value_message:
        return mavlink.MAVLink_param_value_message(
            parameter.name.encode(),
            px4.parameter_to_wire(parameter.value, parameter.type),
            parameter.type,
            len(self._table),
            self._table.index_of(parameter.name),
        )
