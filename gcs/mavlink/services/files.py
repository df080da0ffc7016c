"""Services of files that an aircraft does not keep, answered so that nobody waits for them."""

import struct

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.dispatcher import Dispatcher, Request

_HEADER = struct.Struct("<HBBBBBBI")
"""Of an FTP payload: sequence, session, opcode, size, requested opcode, burst end, padding, offset."""
_PAYLOAD = 251
_ACK, _NAK = 128, 129
_NONE, _TERMINATE_SESSION, _RESET_SESSIONS = 0, 1, 2
_OPEN_READ, _CALC_CRC, _READ, _BURST_READ, _WRITE, _LIST = 4, 14, 5, 15, 7, 3
_OF_A_SESSION = (_READ, _BURST_READ, _WRITE)
_OF_A_PATH = (_OPEN_READ, _CALC_CRC, _LIST)
_INVALID_SESSION, _UNKNOWN_COMMAND, _NOT_FOUND = 4, 7, 10


class FileServices:
    """FILE_TRANSFER_PROTOCOL, of which every request is refused, and LOG_REQUEST_LIST: there are no logs."""

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of these services."""
        dispatcher.register(mavlink.MAVLink_file_transfer_protocol_message, self._on_file)
        dispatcher.register(mavlink.MAVLink_log_request_list_message, self._on_log_list)

    def _on_file(self, message: mavlink.MAVLink_file_transfer_protocol_message, request: Request) -> None:
        sequence, session, opcode, *_, offset = _HEADER.unpack(bytes(message.payload[: _HEADER.size]))
        if opcode in (_ACK, _NAK):
            return
        data, answer = b"", _ACK
        if opcode not in (_NONE, _TERMINATE_SESSION, _RESET_SESSIONS):
            answer = _NAK
            data = bytes([_error(opcode)])
        header = _HEADER.pack((sequence + 1) & 0xFFFF, session, answer, len(data), opcode, 0, 0, offset)
        payload = list((header + data).ljust(_PAYLOAD, b"\0"))
        request.peer.reply(
            mavlink.MAVLink_file_transfer_protocol_message(0, request.system, request.component, payload)
        )

    def _on_log_list(self, message: mavlink.MAVLink_log_request_list_message, request: Request) -> None:
        request.peer.reply(mavlink.MAVLink_log_entry_message(0, 0, 0, 0, 0))


def _error(opcode: int) -> int:
    """Return why a request cannot be served: no file is there, hence no session; nothing can be changed."""
    if opcode in _OF_A_PATH:
        return _NOT_FOUND
    return _INVALID_SESSION if opcode in _OF_A_SESSION else _UNKNOWN_COMMAND
