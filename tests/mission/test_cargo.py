"""What the grippers hold, and which of them did not do what was commanded, by the payload's mass."""

from dataclasses import replace

import pytest

from gcs.config.system import SystemConfig
from gcs.config.tables import Cargo
from gcs.mission.cargo import CargoState
from gcs.mission.commands import GripperAction
from gcs.mission.route import Gripper

SYSTEM = replace(SystemConfig(), cargo=(Cargo(1, 0.5, True), Cargo(2, 0.8, True), Cargo(4, 0.3, False)))


def leg(action, gripper):
    return Gripper((0.0, 0.0, 0.0), GripperAction[action], gripper, "item 3")


@pytest.mark.parametrize(
    ("commands", "held", "mass"),
    [
        ([], {1, 2}, 3.1),
        ([("RELEASE", 1)], {2}, 2.6),
        ([("RELEASE", 1), ("RELEASE", 1)], {2}, 2.6),
        ([("RELEASE", 0)], set(), 1.8),
        ([("GRAB", 4)], {1, 2, 4}, 3.4),
        ([("RELEASE", 0), ("GRAB", 0)], {1, 2, 4}, 3.4),
    ],
)
def test_mass_follows_from_what_the_grippers_hold(commands, held, mass):
    cargo = CargoState(SYSTEM)
    for command in commands:
        cargo.carry_out(leg(*command))
    assert cargo.held == held and cargo.mass == pytest.approx(mass)


@pytest.mark.parametrize(
    ("mass", "failed"),
    [(1.8, ()), (1.85, ()), (2.3, (1,)), (2.6, (2,)), (3.1, (1, 2)), (3.6, (1, 2)), (1.0, ())],
)
def test_mass_names_the_grippers_that_did_not_release(mass, failed):
    cargo = CargoState(SYSTEM)
    release = leg("RELEASE", 0)
    moved = cargo.moved(release)
    cargo.carry_out(release)
    assert cargo.failed(moved, mass, 0.05) == failed
    cargo.undo(failed)
    assert cargo.held == set(failed)


def test_cargo_lighter_than_the_error_of_the_mass_is_not_judged():
    cargo = CargoState(replace(SystemConfig(), cargo=(Cargo(1, 0.1, True),)))
    cargo.carry_out(leg("RELEASE", 1))
    assert cargo.failed({1}, 3.1, 0.05) == ()
