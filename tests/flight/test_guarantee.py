"""Alarms of the safety guarantee, on steps that are made by hand, and their place in the result of a flight."""

from types import SimpleNamespace

import numpy as np
import pytest

from gcs.config import SystemConfig
from gcs.flight import stack
from gcs.flight.alarms import AlarmLog
from gcs.flight.guarantee import Guarantee, GuaranteeAlarm
from gcs.flight.monitor_step import MonitorStep
from gcs.record.summary_table import void_guarantee
from idc_controller.model.linear import LinearModel
from idc_controller.safety.filter_protocol import SafetyReport

SYSTEM = SystemConfig()
MODEL = LinearModel(SYSTEM.parameters())
MARGIN, BOUND = SYSTEM.avoidance.margin, SYSTEM.safety.planner.tracking
UAV_BOUND = BOUND + SYSTEM.safety.planner.uav_tracking
NAMES = ("vehicle 1", "vehicle 2", "vehicle 3", "vehicle 4", "payload")


def alarms(missed=0.0, off=(0.0, 0.0, 0.0), link=(0.0, 0.0), acceleration=0.0, clear=True, in_air=True, bounded=True):
    """The alarms of one step: a plan that ``missed`` the margin, the payload ``off`` it, a link leaning by ``link``."""
    estimator = stack.estimator(SYSTEM, MODEL)
    flight = SimpleNamespace(mission=SimpleNamespace(system=SYSTEM), control=SimpleNamespace(estimator=estimator))
    x = np.zeros(MODEL.layout.size)
    x[:3] = off
    lean = -acceleration / np.hypot(acceleration, MODEL.parameters.g)  # the link points down to the payload
    x[MODEL.layout.s] = np.array([lean, 0.0] * 4)
    x[MODEL.layout.s][:2] += link
    payload = np.zeros((5, 1, 3))
    payload[2, 0, 0] = acceleration
    bounds = (BOUND, UAV_BOUND) if bounded else (None, None)
    safety = SafetyReport(
        clearance=MARGIN - missed, verified=not missed, nearest="mast", payload_bound=bounds[0], uav_bound=bounds[1]
    )
    record = SimpleNamespace(
        estimate=SimpleNamespace(time=0.0, x=x),
        decision=SimpleNamespace(safety=safety, flat=SimpleNamespace(payload=payload)),
    )
    log = AlarmLog()
    Guarantee(flight)(MonitorStep(0.0, 0.0, flight, None, log, record, in_air, NAMES, clear=clear, steady=True))
    return [(alarm.source, alarm.code, alarm.text) for alarm in log.alarms]


def test_step_that_is_not_verified_is_an_alarm():
    assert alarms() == []
    text = f"the plan keeps {MARGIN - 0.01:.2f} m (margin {MARGIN:.2f} m)"
    assert alarms(missed=0.01) == [("mast", GuaranteeAlarm.PLAN_UNVERIFIED, text)]
    assert alarms(missed=0.01, clear=False) and not alarms(missed=0.01, in_air=False)


def test_plan_into_an_obstacle_voids_the_guarantee():
    text = f"the plan keeps -0.87 m (margin {MARGIN:.2f} m)"
    assert alarms(missed=MARGIN + 0.87) == [("mast", GuaranteeAlarm.SAFETY_GUARANTEE_VOID, text)]


def test_payload_beyond_its_bound_is_an_alarm():
    assert alarms(off=(0.0, 0.6 * BOUND, -0.75 * BOUND)) == []
    raised = alarms(off=(0.0, 1.2 * BOUND, 0.0))
    assert raised[0][:2] == ("payload", GuaranteeAlarm.PLAN_DEVIATION_EXCEEDED)
    assert raised[0][2] == f"{1.2 * BOUND:.2f} m off the plan (bound {BOUND:.2f} m)"
    # On the ground the payload does not follow its plan.
    assert alarms(off=(0.0, 1.2 * BOUND, 0.0), clear=False) == []
    assert alarms(off=(0.0, 1.2 * BOUND, 0.0), bounded=False) == []


def test_vehicle_beyond_its_bound_is_an_alarm_of_its_own():
    lean = UAV_BOUND / SYSTEM.team.link_length
    assert alarms(link=(0.9 * lean, 0.0)) == []
    assert [raised[:2] for raised in alarms(link=(1.1 * lean, 0.0))] == [
        ("vehicle 1", GuaranteeAlarm.PLAN_DEVIATION_EXCEEDED)
    ]


def test_links_that_lean_as_the_plan_accelerates_are_on_it():
    assert alarms(acceleration=2.0) == []


@pytest.mark.parametrize(
    ("exceeded", "text"),
    [
        ({}, ""),
        (
            {"plan_clearance": {"value": -0.871, "limit": 0.0, "time_s": 12.34}},
            "the safety guarantee was void: planned clearance -0.87 m (at least 0.00 m) at 12.3 s",
        ),
        (
            {"payload_deviation": {"value": 0.19, "limit": 0.1, "time_s": 8.0},
             "uav_deviation": {"value": 0.18, "limit": 0.12, "time_s": 8.1}},
            "the safety guarantee was void: payload off the plan 0.19 m (bound 0.10 m) at 8.0 s, "
            "UAVs off the plan 0.18 m (bound 0.12 m) at 8.1 s",
        ),
    ],
)  # fmt: skip
def test_void_guarantee_in_words(exceeded, text):
    summary = {"safety": {"exceeded": exceeded}, "clearance_min_m": 0.4}
    assert void_guarantee(summary) == text
    # Without anything to keep clear of there is no guarantee that could be void.
    without = text if "planned" in text else text.removeprefix("the safety guarantee was void: ")
    assert void_guarantee({**summary, "clearance_min_m": None}) == without
    assert void_guarantee({"safety": None, "clearance_min_m": 0.4}) == ""
