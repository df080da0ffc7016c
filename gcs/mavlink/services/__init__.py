"""The server side of the MAVLink services, as one who is connected to finds them. No socket, no clock.

:mod:`.aircraft` is what they serve, a vehicle or the team; :mod:`.dispatcher` hands each message to its service;
:mod:`.peers` and :mod:`.peer` keep who is connected and what streams there. :mod:`.commands` answers all commands; what
each does is in :mod:`.flight_commands`, :mod:`.modes`, :mod:`.system_commands` and :mod:`.streams`. The others are a
service each.
"""
