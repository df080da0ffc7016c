"""Settings of the links between ground and vehicles: clocks, latencies, retries, copies."""

from dataclasses import dataclass, field

from idc_controller.settings import SettingsTable, setting


@dataclass(frozen=True, eq=False, repr=False)
class ClockSettings(SettingsTable):
    """Estimate of a vehicle's clock from TIMESYNC round trips and the stamps of its telemetry."""

    round_trips: int = setting(10, "", "round trips kept: as long as the stamps, so that both are of one time", ge=4)
    slice: float = setting(0.25, "s", "of which only the stamp that came soonest is kept", gt=0.0)
    slices: int = setting(
        4, "", "such slices kept: few, because a simulated world that stalled does not catch up", ge=1
    )
    recent_round_trips: int = setting(4, "", "round trips whose longest bounds the latency", ge=1)
    queue_window: float = setting(1.25, "s", "of datagrams whose latencies are compared with those of a queue", gt=0.0)
    open_requests: int = setting(100, "", "TIMESYNC requests that may still be answered", ge=1)
    bounds: int = setting(1000, "", "bounds of the offset kept until they are looked at, once a control step", ge=1)
    set_back: float = setting(0.005, "s", "a later stamp that is earlier by more: the clock was set back", gt=0.0)
    jump: float = setting(0.02, "s", "change of the offset at once that is no drift", gt=0.0)
    reboot: float = setting(1.0, "s", "a boot time that falls behind by more is of another boot", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class LinkSettings(SettingsTable):
    """Latency, loss and repetition on a link."""

    delays: int = setting(3, "", "set-points whose median delay is used: a growing latency must be followed", ge=1)
    stamp_error: float = setting(0.01, "s", "by which a healthy vehicle's stamps may be wrong", ge=0.0)
    stamp_step_back: float = setting(
        1.0, "s", "set-point stamps do not follow a clock set back by less; by more: it began anew", gt=0.0
    )
    retry_interval: float = setting(0.5, "s", "between repetitions of an unanswered command or request", gt=0.0)
    tries: int = setting(
        10, "", "of a command: with a third of all datagrams lost, one in a thousand stays unanswered", ge=1
    )
    loss_filter: float = setting(0.05, "", "share of one set-point in the running mean of losses", gt=0.0, le=1.0)
    congestion_lag: float = setting(0.05, "s", "of telemetry: on a congested link copies are not sent", gt=0.0)
    second_copy_loss: float = setting(0.02, "", "set-point loss above which every one is sent twice", gt=0.0)
    third_copy_loss: float = setting(
        0.06, "", "set-point loss, with copies, above which it is sent three times", gt=0.0
    )
    reordering_time: float = setting(
        0.2, "s", "a message may be overtaken by later ones before it counts as lost", gt=0.0
    )
    clock: ClockSettings = field(default_factory=ClockSettings)


@dataclass(frozen=True, eq=False, repr=False)
class IdCheckSettings(SettingsTable):
    """Detection of swapped system ids."""

    distance_ratio: float = setting(
        2.0, "", "a position so many times nearer to another vehicle's estimate than to its own is the other's", gt=1.0
    )
    steps: int = setting(3, "", "consecutive control steps in which it must be so", ge=1)


@dataclass(frozen=True, eq=False, repr=False)
class MavlinkSettings(SettingsTable):
    """All of the above."""

    link: LinkSettings = field(default_factory=LinkSettings)
    id_check: IdCheckSettings = field(default_factory=IdCheckSettings)
