"""``docs/failsafes.md`` from the tables of failsafes and alarms: ``python tests/pages/failsafes_page.py`` prints it."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from page_tables import markdown_table

from gcs.config import SystemConfig
from gcs.config.flight_settings import DEFAULTS
from gcs.flight.delivery import DeliveryAlarm
from gcs.flight.detectors import MonitorAlarm
from gcs.flight.failsafe import Failsafe
from gcs.flight.guarantee import GuaranteeAlarm
from gcs.flight.phase import Phase
from gcs.mavlink import px4
from gcs.mavlink.team_failsafe import Reaction, TeamState
from vehicle_sim.autopilot import failsafe as coupled
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.free import failsafe as free
from vehicle_sim.autopilot.free import parameters as names
from vehicle_sim.autopilot.vehicle_parameters import vehicle_parameters

REACTIONS = [reaction for reaction in Reaction if reaction]


def listing() -> str:
    """Return the whole page, with the default thresholds and parameters."""
    reactions = markdown_table(
        [{"reaction, in ascending severity": f"`{each.name}`", "what is done": each.meaning} for each in REACTIONS]
    )
    failsafes = markdown_table([
        {
            "code": f"`{row.code}`", "condition": row.meaning.format(**asdict(DEFAULTS.failsafe)),
            "evaluated": row.check.value, "reaction": f"`{row.reaction.name}`", "severity": row.severity.name.lower(),
            "what to do": row.action,
        }
        for row in Failsafe
    ])  # fmt: skip
    alarms = markdown_table([
        {
            "code": f"`{row.code}`", "meaning": row.meaning.format(**asdict(DEFAULTS.monitor)),
            "evaluated": row.scope.value, "severity": row.severity.name.lower(), "what to do": row.action,
        }
        for row in (*MonitorAlarm, *GuaranteeAlarm, *DeliveryAlarm)
    ])  # fmt: skip
    failsafe = SystemConfig().autopilot.failsafe
    return f"""# Failsafes and alarms

This page is made from the code by `make docs`. Thresholds are those of the default settings
(`gcs/config/flight_settings.py`), and parameters have the vehicles' defaults.

What ends or changes a flight is in two tables. The [ground's](#failsafes-of-the-ground) is evaluated on the whole team,
and acts by commands to all vehicles. The [vehicles'](#failsafes-of-a-vehicle) is evaluated on board, each for itself,
and acts where the ground does not reach them any more: they do the same at the same time, as each has the same stop
plan. Both act by one table of states (`gcs/mavlink/team_failsafe.py`). Each has one next state, which the ground
commands by the most severe of its reactions, and a vehicle enters by its failsafe, after the time of a parameter:

{states()}
`HOLD` ends at the time in the stop plan, or without a plan the parameter's time after the loss; the ground commands
`LAND` then. `LAND` ends with the touch-down. Where a state does not allow a reaction, the nearest that it allows is
made; `END_CONTROL` is allowed in each. In the spool-up the team is in `OFFBOARD` once the thrust has lifted the
vehicles from their cradles: a vehicle that is lost holds its place by it, and the others with it; for less the rotors
spool down.

Only `offboard_loss` can end in the state before: a vehicle flies set-points again when two arrive. Where the ground has
seen that it left them (`offboard_left`), it commands all to land.

## Failsafes of the ground

Every condition that ends or changes a flight is a member of `Failsafe` in `gcs/flight/failsafe.py`. Of several
conditions the one with the most severe reaction counts; a reaction that is under way gives way only to a more severe
one. Of equally severe ones that of the whole team counts, then that of the first vehicle, then the order of the table.

{reactions}
{failsafes}
## Failsafes of a vehicle

Of a vehicle that carries a payload with others (`vehicle_sim/autopilot/failsafe.py`); the first condition that holds
counts. "That time" is the parameter's, in seconds. The default of `{px4.PARAM_SETPOINT_LOSS}` is
`flight.failsafe.telemetry_timeout` of the system file, so that ground and vehicles act at the same age; those of
`{px4.PARAM_LINK_LOSS}` and `{px4.PARAM_LAND_DELAY}` ({failsafe.land_delay:g} s) are `link_loss` and `land_delay` of its
table `autopilot.failsafe`. A vehicle in failsafe reports it in its HEARTBEAT (`MAV_STATE_CRITICAL`).

{of_vehicles(coupled.FAILSAFES, free=False)}
## Failsafes of a free vehicle

Of a vehicle without a payload (`vehicle_sim/autopilot/free/failsafe.py`): what PX4 does without a remote control. With
`{px4.PARAM_LINK_LOSS_ACTION}` 0, the default, silence of all grounds has no effect; 1 holds, 2 returns, 3 lands. Only
the HEARTBEATs of ground stations (`MAV_TYPE_GCS`) count, and with an action a vehicle is not armed without them.
`{names.FENCE_ACTION}` 0 does nothing, 1 warns, 2 holds, 3 returns, 5 lands. Without a position a vehicle brakes and
descends by dead reckoning from its accelerometer and attitude, and refuses modes that need a position; attitude
set-points of OFFBOARD do not.

{of_vehicles(free.FAILSAFES, free=True)}
## Alarms

What the detectors in `gcs/flight/detectors.py`, `guarantee.py` and `delivery.py` find changes nothing by itself. With
the failsafes they are the codes of `alarms.csv` in the run folder; severities are those of MAV_SEVERITY. "Clear of the
ground" is 0.3 m above it.

{alarms}"""


def states() -> str:
    """Return the table of the team's states."""
    return markdown_table([
        {
            "state": f"`{state.name}`", "mode of the vehicles": f"`{px4.mode_name(state.mode)}`",
            "phases": ", ".join(each.value for each in Phase if each.state is state and each is not Phase.ENDED),
            "reactions": " to ".join(f"`{each.name}`" for each in dict.fromkeys(state.reactions)),
            "failsafe on board": ", ".join(f"`{row.name}`" for row in coupled.FAILSAFES if row.state is state),
            "timer": state.timer and f"`{state.timer}`", "next": f"`{state.next.name}`",
        }
        for state in TeamState
    ])  # fmt: skip


def of_vehicles(failsafes: Sequence[coupled.Failsafe[Any]], *, free: bool) -> str:
    """Return the table of a vehicle's failsafes, with the default of each parameter."""
    config = SystemConfig()
    parameters = vehicle_parameters(Airframe.of_config(config.uav), 1, 1, config.autopilot, free=free)
    return markdown_table([
        {
            "failsafe": f"`{row.name}`", "condition": row.meaning, "parameter": f"`{row.parameter}`",
            "default": f"{parameters[row.parameter]:g}", "next state, or action": row.reaction,
            "STATUSTEXT": row.notice,
        }
        for row in failsafes
    ])  # fmt: skip


if __name__ == "__main__":
    print(listing(), end="")
