"""Studies: the same missions flown again with one thing changed at a time, to see what depends on it, and how far."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from gcs.campaign.courses.campaign import fly_all, keep_result, read_result
from gcs.campaign.courses.flights import COLUMNS, FlightPlan, Result
from gcs.campaign.courses.generator import HELD_TO, RandomCourse, generate
from gcs.campaign.courses.moving import top_speed
from gcs.campaign.courses.text import system_text
from gcs.campaign.process_pool import all_cores, sole_flyer, write_table
from gcs.config import SystemConfig
from gcs.config.text_file import read_text
from gcs.errors import UnusableInput
from gcs.mission.model import AnyMotion, Motion
from gcs.mission.read import read_mission
from gcs.record.run_folder import make_folder

MARGIN = "avoidance.margin"
FAST = 0.85
"""Share of the asked speed that the fastest obstacle of a moving course reaches at least."""
SPHERES = "figure_eight_spheres"
MOVING = "moving courses"
"""In place of a mission's name: random courses with spheres that move, none of them on the ground's map."""


@dataclass(frozen=True)
class Variant:
    """One way of flying: ``changes`` to the system file by key, and how fast the obstacles of random courses are.

    ``value`` is where it stands on the axis of the picture; None: by its label.
    """

    label: str
    value: float | None = None
    changes: Mapping[str, Any] = field(default_factory=dict)
    controller: str = "idc"
    fastest: float = 2.0


@dataclass(frozen=True)
class Study:
    """What is flown, and what the picture's axis means. ``seeds`` is the number of flights of each kind by default."""

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
        Study("margin", "the room asked for between hull and obstacles", "margin asked for (m)", (SPHERES,),
              _values(MARGIN, "m", 0.25, 0.5, 0.75, 1.0)),
        Study("mass", "a payload lighter and heavier than the controller believes", "true over believed payload mass",
              (SPHERES,), _values("world.payload_mass_factor", "", 0.9, 1.0, 1.1)),
        Study("rate-noise", "noise of the payload's rates (rad/s) and velocity (m/s)",
              "standard deviation (rad/s and m/s)", (SPHERES,),
              tuple(_rate_noise(sigma) for sigma in (0.008, 0.012, 0.035, 0.1)), logarithmic=True),
        Study("speed", "how fast the obstacles found in flight are", "speed of the fastest obstacle (m/s)",
              (MOVING,), tuple(Variant(f"{v:g} m/s", v, fastest=v) for v in (2.0, 3.0, 4.0, 5.0)), seeds=20, quick=2),
        Study("detection", "how far the range sensors see, obstacles at 2 m/s", "range of the sensors (m)",
              (MOVING,), _values("range_sensor.range", "m", 10.0, 7.0, 5.0, 3.0), seeds=20, quick=2),
        Study("controllers", "the controllers on the same missions", "", ("figure_eight", SPHERES, "pole_course"),
              tuple(Variant(name, controller=name) for name in ("idc", "mpc", "paper"))),
        Study("barrier", "what the barrier adds to plain distance rows", "", (SPHERES, "pole_course"),
              tuple(_barrier(rates) for rates in ([], [5.0], [3.0], [6.0, 6.0]))),
    )
}  # fmt: skip


@dataclass(frozen=True)
class StudyOptions:
    """What the command line of ``gcs study`` asks for. ``seeds``: flights of each kind; None: the study's own."""

    study: Study
    out: Path
    seeds: int | None = None
    quick: bool = False
    jobs: int | None = None
    missions: Path = Path("missions")
    keep: str = "failures"


@dataclass(frozen=True)
class StudyFlight:
    """One flight of a study."""

    mission: str
    variant: Variant
    seed: int
    plan: FlightPlan
    result_path: Path


@dataclass(frozen=True)
class StudyRow:
    """One flight and what came of it."""

    flight: StudyFlight
    result: Result

    def columns(self) -> dict[str, Any]:
        """The row of the table, in the order of :data:`STUDY_COLUMNS`."""
        flight, held_to = self.flight, self.flight.plan.held_to
        own = (flight.mission, flight.variant.label, flight.seed, held_to.clearance, held_to.payload_tilt_deg)
        return dict(zip(_OWN_COLUMNS, own, strict=True)) | dataclasses.asdict(self.result)


_OWN_COLUMNS = ("mission", "variant", "seed", "clearance_asked_m", "tilt_limit_deg")
STUDY_COLUMNS = (*_OWN_COLUMNS, *COLUMNS)


class StudyFlights:
    """The flights of a study in a folder.

    ``systems/`` and ``missions/`` hold what is flown where it is not a mission as it is, ``flights/`` the run folders,
    ``results/`` what came of each. A flight that is there already, of this study or of another one in the same folder,
    is not flown again: its file is named after everything that it was flown by, except the program itself.
    """

    def __init__(self, options: StudyOptions) -> None:
        """Write what will be flown. Raises :class:`UnusableInput` for a mission that cannot be read, and where it
        cannot write."""
        self.options = options
        for name in ("missions", "systems", "flights", "results"):
            make_folder(options.out / name)
        study = options.study
        self._courses: dict[float, tuple[list[str], Iterator[str]]] = {}
        seeds = options.seeds or (study.quick if options.quick else study.seeds)
        self.flights = [
            self._flight(number, mission, variant, seed)
            for number, (mission, variant, seed) in enumerate(
                ((m, v, s) for m in study.missions for v in study.variants for s in range(1, seeds + 1)), start=1
            )
        ]
        self.results: list[Result] = []
        self._results: dict[str, Result] = {}
        for flight in self.flights:
            if (result := read_result(flight.result_path)) is not None:
                self._add(flight.plan, result)

    @property
    def total(self) -> int:
        """Number of flights."""
        return len(self.flights)

    @property
    def rows(self) -> list[StudyRow]:
        """Of the flights flown so far, in their order."""
        flown = ((flight, self._results.get(flight.plan.course.name)) for flight in self.flights)
        return [StudyRow(flight, result) for flight, result in flown if result is not None]

    def fly(self, started: Callable[[str], None], ended: Callable[[Result], None]) -> None:
        """Fly those that have no result yet; as :meth:`Campaign.fly`."""
        paths = {flight.plan.course.name: flight.result_path for flight in self.flights}

        def kept(plan: FlightPlan, result: Result) -> None:
            self._add(plan, result)
            keep_result(paths[plan.course.name], plan, result, self.options.keep)
            ended(result)

        plans = [flight.plan for flight in self.flights if flight.plan.course.name not in self._results]
        with sole_flyer(self.options.out):
            fly_all(plans, self.options.jobs or all_cores(), started, kept)

    def write_rows(self) -> Path:
        """Write ``NAME.csv``, a row a flight."""
        path = self.options.out / f"{self.options.study.name}.csv"
        return write_table(path, STUDY_COLUMNS, [row.columns() for row in self.rows])

    def _add(self, plan: FlightPlan, result: Result) -> None:
        # Flown by another study, it was counted and called otherwise.
        result = dataclasses.replace(result, number=plan.course.number, kind=plan.course.kind)
        self.results.append(result)
        self._results[plan.course.name] = result

    def _flight(self, number: int, mission: str, variant: Variant, seed: int) -> StudyFlight:
        flags = ["--controller", variant.controller]
        changes = _real_changes(variant.changes)
        if changes:
            # Compared by their text: a flight of another study of the folder is the same where its values are.
            system = self.options.out / "systems" / f"{_plain(_told(changes))}.toml"
            self._write(system, system_text(changes))
            flags += ["--config", str(system)]
        if mission == MOVING:
            path, told, text = self._moving_course(variant.fastest, seed)
            held_to = HELD_TO
        else:
            path = self.options.missions / f"{mission}.toml"
            told, text = mission, read_text(path)
            limits = read_mission(path).limits or HELD_TO
            flags += ["--seed", str(seed)]
            # A mission with a clearance to keep is held to the margin, where that is what is asked.
            asked = variant.changes.get(MARGIN, limits.clearance) if limits.clearance is not None else None
            held_to = dataclasses.replace(limits, clearance=asked)
        told = " ".join([told, variant.controller, _told(changes), f"seed{seed}"])
        name = _plain(f"{told} {_digest(text, system_text(changes), repr(held_to))}")
        plan = FlightPlan(
            RandomCourse(number, variant.label, name, text),
            path,
            self.options.out / "flights" / name,
            tuple(flags),
            held_to,
        )
        return StudyFlight(mission, variant, seed, plan, self.options.out / "results" / f"{name}.json")

    def _moving_course(self, fastest: float, number: int) -> tuple[Path, str, str]:
        """A random course of seed 1, its file, and how it is called."""
        told = f"moving{fastest:g}"
        courses = self._courses.setdefault(fastest, ([], fast_courses(fastest)))
        while len(courses[0]) < number:
            courses[0].append(next(courses[1]))
        path, text = self.options.out / "missions" / f"{told}-{number:04d}.toml", courses[0][number - 1]
        self._write(path, text)
        return path, told, text

    @staticmethod
    def _write(path: Path, text: str) -> None:
        try:
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise UnusableInput(f"{path}: cannot be written: {error.strerror}") from None


def fast_courses(fastest: float) -> Iterator[str]:
    """Missions: the moving courses of seed 1 that have an obstacle which does go at about ``fastest`` (m/s).

    A course has obstacles of any speed up to that. These are chosen by how they are laid out, not how they are flown.
    """
    motions: TypeAdapter[AnyMotion] = TypeAdapter(Motion)
    for number in count(1):
        text = generate(1, number, "moving", fastest=fastest).text
        obstacles = tomllib.loads(text)["obstacle"]
        speeds = [top_speed(motions.validate_json(json.dumps(obstacle["motion"]))) for obstacle in obstacles]
        if max(speeds) >= FAST * fastest:
            # What is on the map is seen from any distance: here everything has to be found.
            yield text.replace("known = true", "known = false")


def _real_changes(changes: Mapping[str, Any]) -> dict[str, Any]:
    """Without those that ask for what the system file has anyway."""
    tables = SystemConfig().tables()
    return {key: value for key, value in changes.items() if _lookup(tables, key) != value}


def _lookup(tables: Mapping[str, Any], key: str) -> Any:
    found: Any = tables
    for part in key.split("."):
        found = found[part]
    return found


def _told(changes: Mapping[str, Any]) -> str:
    return " ".join(f"{key.rpartition('.')[2]} {value}" for key, value in changes.items())


def _plain(text: str) -> str:
    """As part of a file name."""
    return re.sub(r"[^\w.]+", "-", text).strip("-")


def _digest(*texts: str) -> str:
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:8]
