"""The narrowest gap on the widest path of the formation, where it is, and what it is between."""

import math

import numpy as np
import pytest
from detours import gap_among
from hypothesis import given, settings
from hypothesis import strategies as st

from idc_controller.geometry.free_space import BoundingCylinder, FreeSpace
from idc_controller.geometry.shapes import Box, Pole, Sphere, Wall
from idc_controller.guidance.narrowest_gap import WIDEST

FORMATION = BoundingCylinder(1.3, 3.5, 0.25)
MARGIN, LOWEST, HIGHEST = 0.7, 0.35, 13.0
START, GOAL = np.array([0.0, 0.0, -5.0]), np.array([20.0, 0.0, -5.0])
TALL = 18.0


def gap_of(obstacles, start=START, goal=GOAL, **more):
    return gap_among(obstacles, start, goal, FORMATION, MARGIN, lowest=LOWEST, highest=HIGHEST, **more)


def wall(x, y, size, bottom=0.0, yaw=0.0):
    return Wall(size, yaw), [x, y, -bottom - size[2] / 2.0]


def room(door, offset=0.0):
    """Walls about the start, with a door in the one towards the goal."""
    left, right = 8.0 + offset - door / 2.0, 8.0 - offset - door / 2.0
    return [
        wall(0.0, -8.0, (30.0, 0.4, TALL)),
        wall(0.0, 8.0, (30.0, 0.4, TALL)),
        wall(-15.0, 0.0, (0.4, 16.4, TALL)),
        wall(10.0, -8.0 + left / 2.0, (0.4, left, TALL)),
        wall(10.0, 8.0 - right / 2.0, (0.4, right, TALL)),
    ]


@pytest.mark.parametrize("obstacles", [[], [wall(10.0, 0.0, (0.4, 8.0, TALL))], [(Pole(0.3, 9.0), [10.0, 0.0, -4.5])]])
def test_open_country_has_no_narrow_gap(obstacles):
    assert gap_of(obstacles) is None


@settings(deadline=None, derandomize=True, max_examples=30)
@given(st.floats(0.2, 6.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi))
def test_door_is_the_narrowest_gap_whatever_the_heading(door, offset, heading):
    turn = np.array([[math.cos(heading), -math.sin(heading)], [math.sin(heading), math.cos(heading)]])
    turned = [
        (Wall(shape.size, heading), np.array([*(turn @ np.array(centre[:2])), centre[2]]))
        for shape, centre in room(door, offset)
    ]
    gap = gap_of(turned, goal=np.array([*(turn @ GOAL[:2]), GOAL[2]]), names=["a", "b", "c", "left", "right"])
    assert gap.width == pytest.approx(door, abs=1e-6)
    assert gap.clearance == pytest.approx(door / 2.0 - FORMATION.radius, abs=0.02)
    assert gap.place[:2] == pytest.approx(turn @ [10.0, offset], abs=0.3)
    assert gap.names == ("left", "right") and not gap.is_height


def test_second_door_that_is_wider_is_taken():
    walls = [*room(2.0)[:3], *(wall(10.0, y, (0.4, edge, TALL)) for y, edge in ((-7.0, 2.0), (-1.0, 4.0), (6.0, 4.0)))]
    gap = gap_of(walls)  # doors from -6 to -3 and from 1 to 4: both 3 m wide
    assert gap.width == pytest.approx(3.0, abs=1e-6)
    walls[-1] = wall(10.0, 6.5, (0.4, 3.0, TALL))  # now from 1 to 5
    assert gap_of(walls).width == pytest.approx(4.0, abs=1e-6)


def test_narrower_of_two_doors_one_after_another_counts():
    behind = [wall(14.0, -8.0, (8.0, 0.4, TALL)), wall(14.0, 8.0, (8.0, 0.4, TALL))]
    second = [wall(18.0, -5.0, (0.4, 6.4, TALL)), wall(18.0, 5.0, (0.4, 7.4, TALL))]  # from -1.8 to 1.3
    gap = gap_of([*room(4.0), *behind, *second], goal=np.array([30.0, 0.0, -5.0]))
    assert gap.width == pytest.approx(3.1, abs=1e-6)
    assert gap.place[0] == pytest.approx(18.0, abs=0.3)


def test_room_without_door_is_closed():
    gap = gap_of([*room(2.0), wall(10.0, 0.0, (0.4, 4.0, TALL))])
    assert gap.width == 0.0 and gap.names


def test_walls_that_can_be_flown_over_with_margin_leave_the_way_open():
    low = HIGHEST - MARGIN - FORMATION.below
    walls = [(Wall((*shape.size[:2], low - 0.1)), [*centre[:2], -(low - 0.1) / 2.0]) for shape, centre in room(1.0)]
    assert gap_of(walls) is None
    walls = [(Wall((*shape.size[:2], low + 0.1)), [*centre[:2], -(low + 0.1) / 2.0]) for shape, centre in room(1.0)]
    assert gap_of(walls).width == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("height", [3.4, 4.2, 5.0])
def test_lintel_makes_the_gap_a_height(height):
    lintel = wall(10.0, 0.0, (0.4, 7.0, TALL - height), bottom=height)
    gap = gap_of([*room(6.9), lintel], names=["a", "b", "c", "d", "e", "lintel"])
    assert gap.is_height and gap.names == ("lintel",)
    assert gap.width == pytest.approx(height, abs=1e-6)
    needed = FORMATION.above + FORMATION.below + LOWEST - FORMATION.below
    assert gap.clearance == pytest.approx(height - needed, abs=0.02)
    assert gap.place[0] == pytest.approx(10.0, abs=0.3)


def test_spheres_count_by_their_section_at_the_formation_s_heights():
    spheres = [(Sphere(2.0), [10.0, y, -11.0]) for y in (-4.0, 4.0)]  # 4 m between them, far above
    walls = room(7.0)
    assert gap_of([*walls, *spheres]) is None or gap_of([*walls, *spheres]).clearance > 1.9


def test_waypoint_too_near_an_obstacle_is_the_gap():
    gap = gap_of([(Pole(0.5, TALL), [20.0, 1.5, -TALL / 2.0])], names=["mast"])
    assert gap.is_at_waypoint and gap.names == ("mast",)
    assert gap.width == pytest.approx(2.0, abs=1e-6)


def test_growth_narrows_the_gap():
    walls = room(3.0)
    assert gap_of(walls, growth=np.full(len(walls), 0.2)).width == pytest.approx(2.6, abs=1e-6)


def test_tilted_box_counts_by_its_plan_view():
    leaning = Box((0.4, 0.4, 14.0), pitch=math.radians(10.0))
    beside = Pole(0.3, TALL)
    walls = [*room(6.0), (leaning, [10.0, -1.0, -7.0]), (beside, [10.0, 2.0, -TALL / 2.0])]
    assert gap_of(walls).width < 3.0


@settings(deadline=None, derandomize=True, max_examples=15)
@given(st.integers(0, 2**31))
def test_random_poles_leave_the_clearance_that_a_fine_lattice_finds(seed):
    """Poles in a corridor, without ways round: the clearance agrees with a flood fill over a lattice of 0.1 m."""
    from scipy.ndimage import label

    random = np.random.default_rng(seed)
    walls = [wall(10.0, y, (50.0, 0.4, TALL)) for y in (-6.0, 6.0)]
    ends = [wall(x, 0.0, (0.4, 12.0, TALL)) for x in (-6.0, 26.0)]
    poles = [
        (Pole(float(random.uniform(0.1, 0.5)), TALL), [random.uniform(4.0, 16.0), random.uniform(-5.5, 5.5), -9.0])
        for _ in range(8)
    ]
    obstacles = [*walls, *ends, *poles]
    gap = gap_of(obstacles)
    step = 0.1
    x, y = np.arange(-5.0, 25.0 + step, step), np.arange(-5.5, 5.5 + step, step)
    places = np.array([[a, b, -5.0] for a in x for b in y])
    clearance = FreeSpace(obstacles, FORMATION, 0.0, 0.0, 100.0).clearance(places).min(axis=1).reshape(len(x), len(y))

    def joined(least):
        parts, _ = label(clearance >= least, np.ones((3, 3)))
        at = [parts[np.argmin(abs(x - p[0])), np.argmin(abs(y - p[1]))] for p in (START, GOAL)]
        return at[0] == at[1] != 0

    found = gap.clearance if gap is not None else WIDEST
    assert joined(found - 0.12)
    assert not joined(found + 0.05) or gap is None


def test_gap_in_words_names_width_place_and_bodies():
    text = str(gap_of(room(2.5), names=["a", "b", "c", "left", "right"]))
    assert text.startswith("2.50 m wide at ") and text.endswith("(left and right)")
    assert "10" in text or "9.8" in text
