"""The largest link latency at which the loop is closed: less where set-points are lost (docs/link-margin.md)."""

from collections.abc import Sequence

from gcs.config.flight_settings import FailsafeSettings
from gcs.flight.condition import Trigger
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.control.delay_margin import expected_extra_age


def latency_limit(settings: FailsafeSettings, loss: float, period: float) -> float:
    """Return the largest latency (s), one way, where a share ``loss`` of the set-points is lost.

    ``period`` of the set-points (s). The set-point in force is older than the latency by those lost before it. A third
    of what the loop bears of that age is allowed: ``loss_age`` at the limit without loss, linearly more at less
    latency, and up to ``latency_any_loss`` whatever is lost.
    """
    age, (at_limit, at_any) = expected_extra_age(min(loss, 0.99), period), settings.loss_age
    share = min(max((at_any - age) / (at_any - at_limit), 0.0), 1.0)
    most = settings.latency_limit
    least = min(settings.latency_any_loss, most)
    return least + share * (most - least)


def latency_exceeded(
    links: Sequence[VehicleLink], settings: FailsafeSettings, period: float, now: float
) -> Trigger | None:
    """Return the first link that is too slow for what it loses, or whose latency is not known any more; None: none.

    ``period`` of the set-points (s), ``now`` on the ground's clock (s).
    """
    for i, link in enumerate(links):
        latency, clock = link.clock.delay, link.clock
        limit = latency_limit(settings, link.setpoints.loss, period)
        if clock.round_trip_max > 2.0 * limit:  # or the least delay is not beyond the limit
            latency = max(latency, clock.least_delay(settings.latency_window, now))
        if latency > limit:
            text = f"link latency to vehicle {link.system_id} is {latency * 1e3:.0f} ms (limit {limit * 1e3:.0f} ms"
            lost = f" at {link.setpoints.loss:.0%} loss of set-points" if limit < settings.latency_limit else ""
            return Trigger(f"{text}{lost})", (i,))
        silence = now - clock.answered_at
        if silence > settings.timesync_timeout:
            text = f"link latency to vehicle {link.system_id} is not known: no TIMESYNC answer for {silence:.1f} s"
            return Trigger(text, (i,))
    return None
