"""Settings of the links between ground and vehicles: clocks, latencies, retries, copies."""

from dataclasses import dataclass, field

from idc_controller.settings import SettingsTable, Share


@dataclass(frozen=True, eq=False, repr=False)
class ClockSettings(SettingsTable):
    """Estimate of a vehicle's clock from TIMESYNC round trips and the stamps of its telemetry."""

    round_trips: int = 10  # round trips kept: as long as the stamps, so that both are of one time
    slice: float = 0.25  # s; of which only the stamp that came soonest is kept
    slices: int = 4  # such slices kept: few, because a simulated world that stalled does not catch up
    recent_round_trips: int = 4  # round trips whose longest bounds the latency
    recent_stamps: int = 3  # stamps that all come late where the latency has grown
    queue_window: float = 1.25  # s; of datagrams whose latencies are compared with those of a queue
    open_requests: int = 100  # TIMESYNC requests that may still be answered
    bounds: int = 1000  # bounds of the offset kept until they are looked at, once a control step
    set_back: float = 0.005  # s; a later stamp that is earlier by more: the clock was set back
    jump: float = 0.02  # s; change of the offset at once that is no drift
    reboot: float = 1.0  # s; a boot time that falls behind by more is of another boot


@dataclass(frozen=True, eq=False, repr=False)
class LinkSettings(SettingsTable):
    """Latency, loss and repetition on a link."""

    delays: int = 3  # set-points whose median delay is used: a growing latency must be followed
    stamp_error: float = 0.01  # s; by which a healthy vehicle's stamps may be wrong
    stamp_step_back: float = 1.0  # s; set-point stamps do not follow a clock set back by less; by more: it began anew
    # s; between repetitions of an unanswered mode command, a control period: vehicles that are to hold do so together
    mode_interval: float = 0.05
    retry_interval: float = 0.5  # s; between repetitions of any other, longer than a round trip that is flown with
    tries: int = 10  # of it: with a third of all datagrams lost, one in a thousand stays unanswered
    loss_filter: Share = 0.05  # share of one set-point in the running mean of losses
    congestion_lag: float = 0.05  # s; of telemetry: on a congested link copies are not sent
    second_copy_loss: float = 0.02  # set-point loss above which every one is sent twice
    third_copy_loss: float = 0.06  # set-point loss, with copies, above which it is sent three times
    reordering_time: float = 0.2  # s; a message may be overtaken by later ones before it counts as lost
    clock: ClockSettings = field(default_factory=ClockSettings)


@dataclass(frozen=True, eq=False, repr=False)
class IdCheckSettings(SettingsTable):
    """Detection of swapped system ids."""

    # a position so many times nearer to another vehicle's estimate than to its own is the other's
    distance_ratio: float = 2.0
    steps: int = 3  # consecutive control steps in which it must be so


@dataclass(frozen=True, eq=False, repr=False)
class PeerSettings(SettingsTable):
    """Service of an aircraft to its peers: every address that sends it valid MAVLink."""

    peer_timeout: float = 10.0  # s; without a message from a peer until its streams stop
    peer_silence: float = 2.5  # s; without a message after which a newcomer may take its place: two HEARTBEATs missed
    peers_max: int = 8  # peers served at once, beside the ports of clients to which it always sends
    replies_max: int = 200  # answers queued for one peer; more requests at once are dropped
    interval_min: float = 0.004  # s; shortest interval that SET_MESSAGE_INTERVAL may set: the onboard loop's period
    repeat_interval: float = 0.04  # s; between the repetitions of a message whose content changed
    repeats: int = 3  # repetitions of a message whose content changed: a datagram may be lost


@dataclass(frozen=True, eq=False, repr=False)
class MissionTransferSettings(SettingsTable):
    """The mission protocol of an aircraft: PX4's numbers."""

    retry_interval: float = 0.25  # s; between requests of an item that does not come
    timeout: float = 5.0  # s; without a message of the ground that uploads or downloads until its transfer ends
    mission_items_max: int = 2000  # items of a mission
    fence_items_max: int = 64  # items of a fence: vertices and circles
    rally_points_max: int = 32  # rally points
    partial_list_max: int = 64  # items sent for one MISSION_REQUEST_PARTIAL_LIST
    downloads_max: int = 16  # grounds that download at once, each with the plan that it was promised


@dataclass(frozen=True, eq=False, repr=False)
class MavlinkSettings(SettingsTable):
    """All of the above."""

    link: LinkSettings = field(default_factory=LinkSettings)
    id_check: IdCheckSettings = field(default_factory=IdCheckSettings)
