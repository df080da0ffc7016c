"""MAVLink: the protocol that both ends share, and the ground's links to the vehicles.

Shared: :mod:`~gcs.mavlink.codec`, :mod:`~gcs.mavlink.frames`, :mod:`~gcs.mavlink.layout` and
:mod:`~gcs.mavlink.messages` (bytes to typed messages and back), :mod:`~gcs.mavlink.px4` (modes, parameters,
components), :mod:`~gcs.mavlink.team_failsafe`, :mod:`~gcs.mavlink.stop_plan`, :mod:`~gcs.mavlink.lockstep`,
:mod:`~gcs.mavlink.udp`, :mod:`~gcs.mavlink.address`.
The server side of the services is :mod:`gcs.mavlink.services`. All other modules are the ground's; ``vehicle_sim``
imports none of them.
"""
