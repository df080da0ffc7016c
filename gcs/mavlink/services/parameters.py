"""The MAVLink parameter protocol, in PX4's byte-wise flavour."""

import struct
from collections.abc import Iterable

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.messages import BROADCAST, Message
from gcs.mavlink.services.aircraft import Control
from gcs.mavlink.services.dispatcher import Dispatcher, Request
from gcs.mavlink.services.parameter_table import ParameterRefusalError, ParameterTable
from gcs.mavlink.services.peer import Peer

_VALUE = LAYOUTS[mavlink.MAVLINK_MSG_ID_PARAM_VALUE]
_HASH = "_HASH_CHECK"
"""By this name PX4 reports the hash of all parameters, so that a ground may use those that it has kept."""
_NO_INDEX = 0xFFFF
_HASH_SIZE = 4
_LIST_INTERVAL = 0.2
"""s; the list that is requested again sooner is on its way: repeated requests must not fill the link."""


class ParameterServer:
    """PARAM_REQUEST_READ, PARAM_REQUEST_LIST and PARAM_SET.

    A refusal is a PARAM_ERROR; of a PARAM_SET the value that is kept follows, for grounds that do not know PARAM_ERROR.
    A value that was set is sent to all peers.
    """

    def __init__(self, table: ParameterTable, control: Control, peers: Iterable[Peer] = ()) -> None:
        """``peers``: all who are connected, whenever it is iterated."""
        self._table = table
        self._control = control
        self._peers = peers

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        dispatcher.register(mavlink.MAVLink_param_request_read_message, self._on_read)
        dispatcher.register(mavlink.MAVLink_param_request_list_message, self._on_list)
        dispatcher.register(mavlink.MAVLink_param_set_message, self._on_set)

    def _on_read(self, message: mavlink.MAVLink_param_request_read_message, request: Request) -> None:
        name, index = message.param_id, message.param_index
        if index < 0 and name == _HASH:
            self._send_hash(request)
            return
        parameter = self._table.by_index(index) if index >= 0 else self._table.by_name(name)
        if parameter is None:
            self._refuse(name, index, mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST, request)
        else:
            request.peer.reply(self._value(parameter.name))

    def _on_list(self, message: mavlink.MAVLink_param_request_list_message, request: Request) -> None:
        if request.now - request.peer.parameters_sent_at < _LIST_INTERVAL:
            return
        request.peer.parameters_sent_at = request.now
        self._send_hash(request)
        for parameter in self._table:
            request.peer.reply(self._value(parameter.name))

    def _on_set(self, message: mavlink.MAVLink_param_set_message, request: Request) -> None:
        name = message.param_id
        if name == _HASH:
            return  # the ground's own: it has all parameters already
        try:
            if message.target_system == BROADCAST:
                raise ParameterRefusalError(
                    f"{name} denied: sent to all systems", mavlink.MAV_PARAM_ERROR_PERMISSION_DENIED
                )
            if self._control.is_stranger(request.sender, request.now):
                raise ParameterRefusalError(
                    f"{name} denied: another ground is in control", mavlink.MAV_PARAM_ERROR_PERMISSION_DENIED
                )
            self._table.set_from_wire(name, message.param_value, message.param_type)
        except ParameterRefusalError as error:
            request.peer.send_statustext(str(error))
            self._refuse(name, -1, error.number, request)
        else:
            for peer in self._peers:
                if peer is not request.peer:
                    peer.reply(self._value(name))
        if self._table.by_name(name) is not None:
            request.peer.reply(self._value(name))

    def _value(self, name: str) -> Message:
        """Return the PARAM_VALUE of an existing parameter."""
        index, count = self._table.index_of(name), len(self._table)
        parameter = self._table.by_index(index)
        assert parameter is not None
        value = px4.parameter_to_wire(parameter.value, parameter.type)
        return mavlink.MAVLink_param_value_message(name.encode(), value, parameter.type, count, index)

    def _send_hash(self, request: Request) -> None:
        layout, payload = _VALUE.pack(0.0, len(self._table), _NO_INDEX, _HASH.encode(), mavlink.MAV_PARAM_TYPE_UINT32)
        # Its bytes may be those of a NaN, which a conversion to a float could change.
        payload = struct.pack("<I", self._table.checksum) + payload[_HASH_SIZE:]
        request.peer.reply_packed((layout, payload))

    def _refuse(self, name: str, index: int, number: int, request: Request) -> None:
        request.peer.reply(
            mavlink.MAVLink_param_error_message(request.system, request.component, name.encode(), index, number)
        )
