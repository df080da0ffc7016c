"""Where the vehicles listen, and the ports of clients to which they send their streams: PX4's."""

from __future__ import annotations

from argparse import Namespace
from typing import NamedTuple

from gcs.errors import UnusableInput
from gcs.mavlink.address import GROUND_PORT, SDK_PORT, THIS_MACHINE, Address, resolved


class ClientPorts(NamedTuple):
    """The host on which the vehicles listen, and the addresses of clients, None: nowhere."""

    listening_host: str
    sdk: Address | None
    """Of vehicle 1; the others send to the ports that follow."""
    ground: Address | None
    """Of all vehicles."""

    @classmethod
    def of(cls, options: Namespace, vehicles: int) -> ClientPorts:
        """Return what the options say for a number of vehicles. Raises :class:`UnusableInput`."""
        if options.lockstep:
            return cls(options.host or THIS_MACHINE, None, None)
        sdk_port = SDK_PORT if options.sdk_port is None else options.sdk_port
        ground_port = GROUND_PORT if options.ground_port is None else options.ground_port
        if sdk_port + vehicles - 1 > 65535:
            raise UnusableInput(f"--sdk-port {sdk_port}: port {sdk_port + vehicles - 1} of vehicle {vehicles} is none")
        there = resolved(options.ground_host or THIS_MACHINE, f"--ground-host {options.ground_host}")
        is_here = there.startswith("127.")
        host = options.host or (THIS_MACHINE if is_here else "0.0.0.0")
        if not is_here and resolved(host, f"--host {host}").startswith("127."):
            raise UnusableInput(
                f"--host {host}: from there nothing can be sent to --ground-host {options.ground_host}; "
                "name an address of this machine in that network, or 0.0.0.0"
            )
        listening = range(options.base_port, options.base_port + vehicles) if options.base_port else range(0)
        taken = {sdk_port + i for i in range(vehicles) if sdk_port} | {ground_port}
        if is_here and (both := taken.intersection(listening)):
            raise UnusableInput(
                f"{vehicles} vehicles from --base-port {options.base_port} on: port {min(both)} is a client's; "
                "choose another, or other ones of --sdk-port and --ground-port (0: nowhere)"
            )
        return cls(host, (there, sdk_port) if sdk_port else None, (there, ground_port) if ground_port else None)
