"""The studies: what is flown again with one parameter changed at a time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from gcs.campaign.scenarios.judgement import COLUMNS

MARGIN = "avoidance.margin"
SPHERES = "figure_eight_spheres"
MOVING = "moving courses"
"""In place of a mission's name: random scenarios with spheres that move, none of them on the map."""


@dataclass(frozen=True)
class Variant:
    """One variant: ``changes`` to the system file by key, and the highest speed of obstacles of random scenarios (m/s).

    ``value`` is its place on the axis of the picture; None: by its label.
    """

    label: str
    value: float | None = None
    changes: Mapping[str, Any] = field(default_factory=dict)
    controller: str = "idc"
    fastest: float = 2.0


@dataclass(frozen=True)
class Study:
    """Flights of a study, and the quantity on its picture's axis. ``seeds``: flights of each kind by default."""

    name: str
    about: str
    axis: str
    missions: tuple[str, ...]
    variants: tuple[Variant, ...]
    seeds: int = 3
    quick: int = 1
    logarithmic: bool = False


def _values(key: str, unit: str, *values: float) -> tuple[Variant, ...]:
    return tuple(Variant(f"{value:g} {unit}".strip(), value, {key: value}) for value in values)


def _rate_noise(sigma: float) -> Variant:
    return Variant(f"{sigma:g}", sigma, {"sensors.payload_rates": sigma, "sensors.payload_velocity": sigma})


def _barrier(rates: Sequence[float]) -> Variant:
    label = ", ".join(f"{rate:g}" for rate in rates) + " 1/s" if rates else "plain rows"
    return Variant(label, None, {"avoidance.barrier_rates": list(rates)})


STUDIES = {
    study.name: study
    for study in (
        Study("margin", "the margin between hull and obstacles", "margin (m)", (SPHERES,),
              _values(MARGIN, "m", 0.25, 0.5, 0.75, 1.0)),
        Study("mass", "a payload lighter and heavier than the controller's model", "true over modelled payload mass",
              (SPHERES,), _values("world.payload_mass_factor", "", 0.9, 1.0, 1.1)),
        Study("rate-noise", "noise of the payload's rates (rad/s) and velocity (m/s)",
              "standard deviation (rad/s and m/s)", (SPHERES,),
              tuple(_rate_noise(sigma) for sigma in (0.008, 0.012, 0.035, 0.1)), logarithmic=True),
        Study("speed", "the speed of obstacles that are detected in flight", "speed of the fastest obstacle (m/s)",
              (MOVING,), tuple(Variant(f"{v:g} m/s", v, fastest=v) for v in (2.0, 3.0, 4.0, 5.0)), seeds=20, quick=2),
        Study("detection", "the range of the range sensors, obstacles at 2 m/s", "range of the sensors (m)",
              (MOVING,), _values("range_sensor.range", "m", 10.0, 7.0, 5.0, 3.0), seeds=20, quick=2),
        Study("controllers", "the controllers on the same missions", "", ("figure_eight", SPHERES, "pole_course"),
              tuple(Variant(name, controller=name) for name in ("idc", "mpc", "paper"))),
        Study("barrier", "what the barrier adds to plain distance rows", "", (SPHERES, "pole_course"),
              tuple(_barrier(rates) for rates in ([], [5.0], [3.0], [6.0, 6.0]))),
    )
}  # fmt: skip


LABELS = ("mission", "variant", "seed", "clearance_asked_m", "tilt_limit_deg")
STUDY_COLUMNS = (*LABELS, *COLUMNS)
"""Columns of the table ``NAME.csv``; the labels are not stored with the results, for studies share their flights."""
