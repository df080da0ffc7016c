"""A flight as a function: :func:`gcs.fly`."""

from __future__ import annotations

import dataclasses
import operator
import signal
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcs.app.arguments import CONTROLLERS
from gcs.app.flown import Flight, flown
from gcs.app.in_process import FlightInProcess
from gcs.app.logs import LOG
from gcs.config import read_system
from gcs.config.overrides import plain, with_settings
from gcs.config.toml_file import GivenTables
from gcs.config.validate import UnusableFile
from gcs.drivers.interrupt import Interrupt
from gcs.drivers.participant import InterruptWatch
from gcs.errors import UnusableInput
from gcs.flight.feasibility import preflight
from gcs.mission.faults import check_faults_of, fault_problems, parameter_problems, read_fault
from gcs.mission.model import Fault, Limits, Mission
from gcs.mission.read import read_mission
from gcs.numerics import differences
from gcs.record.run_folder import NewRunFolder, write_manifest

if TYPE_CHECKING:
    from gcs.campaign.testing import AnyFault


def fly(
    mission: Path | str | Mission,
    *,
    seed: int | None = None,
    config: Path | str | None = None,
    settings: Mapping[str, Any] | None = None,
    controller: str = "idc",
    faults: Iterable[AnyFault] = (),
    limits: Limits | Mapping[str, Any] | None = None,
    run_dir: Path | str | None = None,
) -> Flight:
    """Fly a mission in lockstep with a simulated swarm, in this process, and return the flight.

    The same arguments give the same flight, to the byte that of ``gcs fly`` where that can fly it. Several flights may
    be flown one after the other in a process, and in parallel in several. Ask for ``gcs.fly`` before numpy is imported:
    otherwise the last digits can depend on the processor, which is logged as a warning (logger ``gcs``).

    Args:
        mission: a mission file of any format, the name of one of the package's own (``gcs missions``), or a mission
            built in Python.
        seed: of every random number, in place of the mission's own.
        config: a system file in place of the mission's own.
        settings: values by dotted path, such as ``{"avoidance.margin": 0.3}``, in place of the system file's
            (docs/settings.md). A mission built in Python keeps the route that it has.
        controller: ``idc`` (tracking with obstacle avoidance), ``mpc`` (tracking only) or ``paper`` (the paper's own
            filter).
        faults: after the mission's own, each as the keys of a ``[[fault]]`` table, or as the parameters of a kind, such
            as ``gcs.faults.link.PacketLoss(probability=0.3)``, from take-off to the end.
        limits: in place of the mission's own, as the keys of its table ``[limits]``.
        run_dir: a folder for the records, made if it is absent; None: none is written.

    Raises:
        UnusableInput: (:mod:`gcs.errors`) for whatever cannot be flown, before the flight.
        GcsError: no simulated world is installed.
        KeyboardInterrupt: after Ctrl-C, once the vehicles have landed and the records are closed; at a second one, at
            once.
    """
    tables = _fault_tables(faults)
    checked = _with_faults(as_flown(mission, seed, config, settings or {}, limits), tables)
    if controller not in CONTROLLERS:
        raise UnusableInput(f"controller '{controller}' is none of {', '.join(CONTROLLERS)}")
    for note in (*checked.notes, *preflight(checked).lines):
        LOG.info("note: %s", note)
    replay = _call(
        mission, seed=seed, config=config and str(config), settings={k: plain(v) for k, v in (settings or {}).items()},
        controller=None if controller == "idc" else controller, faults=tables, limits=limits and _limit_table(limits),
    )  # fmt: skip
    with Interrupt((signal.SIGINT,)) as interrupt, ExitStack() as opened:
        wanted = run_dir
        if wanted is None:  # the figures are computed from files
            wanted = Path(opened.enter_context(tempfile.TemporaryDirectory(prefix="cooplift-"))) / "run"
        folder = opened.enter_context(NewRunFolder(checked.name, wanted))
        started = datetime.now(UTC)
        write_manifest(
            folder.path, command=[replay], seed=checked.seed, mission=checked, system=checked.system, start=started
        )
        flight = opened.enter_context(
            FlightInProcess(checked, folder.path, controller=controller, start_epoch=started.timestamp())
        )
        if others := differences():
            LOG.warning(others)
        folder.keep()

        watch = InterruptWatch(interrupt, flight.station)
        interrupt.begin_flight()
        flight.fly(stop=lambda: watch.ends(flight.now))
        interrupt.end_flight()
        if interrupt.requested_again:
            raise KeyboardInterrupt
        found = flown(flight.result(), flight.setpoints, replay, keep=run_dir is not None)
        if interrupt.requested:
            raise KeyboardInterrupt
        return found


def _call(mission: Path | str | Mission, **options: Any) -> str:
    """Return the call of :func:`fly` with those options that are given, as Python source."""
    given = "".join(f", {name}={value!r}" for name, value in options.items() if value not in (None, [], {}))
    return f"gcs.fly({'mission' if isinstance(mission, Mission) else repr(str(mission))}{given})"


def as_flown(
    mission: Path | str | Mission,
    seed: int | None,
    config: Path | str | None,
    settings: Mapping[str, Any],
    limits: Limits | Mapping[str, Any] | None,
) -> Mission:
    """Return the mission as it will be flown, but for further faults. Raises :class:`UnusableInput`."""
    if isinstance(mission, Mission):
        system = mission.system if config is None else read_system(Path(config))
        mission = dataclasses.replace(mission, system=with_settings(system, settings))
        given = GivenTables(Path("mission"), {}, {})
        if problems := [line for i, one in enumerate(mission.faults) for line in parameter_problems(given, i, one)]:
            raise UnusableFile(problems)
        check_faults_of(mission)
    else:
        mission = read_mission(mission, config, settings)
    if seed is not None:
        mission = dataclasses.replace(mission, seed=_seed(seed))
    if limits is not None:
        mission = dataclasses.replace(mission, limits=_limits(limits))
    return mission


def _seed(seed: int) -> int:
    try:
        whole = operator.index(seed)
    except TypeError:
        whole = -1
    if not 0 <= whole < 2**63:
        raise UnusableInput(f"seed {seed!r} is not a whole number from 0 to {2**63 - 1}")
    return whole


def _limits(limits: Limits | Mapping[str, Any]) -> Limits:
    return GivenTables(Path("limits"), _limit_table(limits), {}).validated(Limits)


def _limit_table(limits: Limits | Mapping[str, Any]) -> dict[str, Any]:
    given = limits if isinstance(limits, Mapping) else dataclasses.asdict(limits)
    return {key: value for key, value in given.items() if value is not None}


def _fault_tables(faults: Iterable[AnyFault]) -> list[dict[str, Any]]:
    """Return faults as the keys of ``[[fault]]`` tables. Raises :class:`UnusableInput`."""
    faults = [*faults]
    if not faults:
        return []
    # Campaigns take long to import, spent only where there are faults.
    from gcs.campaign.faults.base_mission import fault_table
    from gcs.campaign.testing import fault

    try:
        return [fault_table(one if isinstance(one, Fault | Mapping) else fault(one)) for one in faults]
    except TypeError as error:
        raise UnusableInput(f"faults: {error}") from None


def _with_faults(mission: Mission, tables: Sequence[Mapping[str, Any]]) -> Mission:
    """Return the mission with faults of ``tables`` after its own. Raises :class:`UnusableInput`."""
    given = GivenTables(Path("faults"), {}, {})
    found = []
    for index, table in enumerate(tables):
        read = read_fault(given, index, table)
        if problems := [
            given.problem(("fault", index, key), reason) for key, reason in fault_problems(read, mission.system)
        ]:
            raise UnusableFile(problems)
        found.append(read)
    return dataclasses.replace(mission, faults=(*mission.faults, *found))
