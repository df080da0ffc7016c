"""Connection URLs: where a vehicle listens, or where the ground listens for vehicles."""

import re
import socket
from dataclasses import dataclass

from gcs.errors import UnusableInput

Address = tuple[str, int]

# PX4's ports; of those that follow one another the first vehicle's.
VEHICLE_PORT = 14580
"""Where a vehicle listens, the next one on the port that follows."""
SDK_PORT = 14540
"""Where an SDK listens for one vehicle, on the port that follows for the next one."""
GROUND_PORT = 14550
"""Where a ground station listens for all vehicles."""
TEAM_PORT = 18570
"""Where a team that is served as one aircraft listens for ground stations."""
THIS_MACHINE = "127.0.0.1"

_URL = re.compile(r"^(?P<scheme>udp|udpout|udpin):(?://)?(?P<host>[^:/\s]+):(?P<port>\d{1,5})/?$")


@dataclass(frozen=True)
class ConnectionUrl:
    """``udp://host:port``, ``udpout://host:port``: a vehicle there; ``udpin://host:port``: the ground listens there."""

    host: str
    port: int
    listens: bool

    @property
    def address(self) -> Address:
        """Host and port, as sockets take them."""
        return self.host, self.port

    def __str__(self) -> str:
        return f"{'udpin' if self.listens else 'udp'}://{self.host}:{self.port}"


def parse_url(text: str, option: str = "--connect") -> ConnectionUrl:
    """Raises :class:`UnusableInput` that names ``option`` when ``text`` is no connection URL."""
    match = _URL.match(text)
    if match is None or not 1 <= int(match["port"]) <= 65535:
        raise UnusableInput(f"{option} {text}: expected udp://HOST:PORT, udpout://HOST:PORT or udpin://HOST:PORT")
    host = resolved(match["host"], f"{option} {text}")
    return ConnectionUrl(host, int(match["port"]), match["scheme"] == "udpin")


def parse_address(text: str, option: str, lowest: int = 1) -> Address:
    """Return the address of ``HOST:PORT``. Raises :class:`UnusableInput` that names ``option`` for anything else.

    ``lowest`` port: 0, for one that the system chooses, only where it is listened.
    """
    host, colon, port = text.rpartition(":")
    if not (host and colon and port.isdecimal() and lowest <= int(port) <= 65535):
        raise UnusableInput(f"{option} {text}: expected HOST:PORT")
    return resolved(host, f"{option} {text}"), int(port)


def resolved(host: str, option: str) -> str:
    """Return the IPv4 address of a machine, looked up once. Raises :class:`UnusableInput` that names ``option``."""
    try:
        return socket.gethostbyname(host)
    except (OSError, UnicodeError) as error:
        raise UnusableInput(f"{option}: {getattr(error, 'strerror', None) or error}") from None
