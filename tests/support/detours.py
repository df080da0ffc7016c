"""Searches for paths among obstacles that are given one by one."""

from idc_controller.geometry.free_space import FreeSpace
from idc_controller.guidance.detour import find_detour
from idc_controller.guidance.narrowest_gap import narrowest_gap


def detour_among(obstacles, start, goal, formation, margin, *, names=None, lowest=0.5, highest=15.0, **others):
    return _searched(find_detour, obstacles, start, goal, formation, margin, lowest, highest, names, **others)


def gap_among(obstacles, start, goal, formation, margin, *, names=None, lowest=0.5, highest=15.0, **others):
    return _searched(narrowest_gap, obstacles, start, goal, formation, margin, lowest, highest, names, **others)


def _searched(
    search, obstacles, start, goal, formation, margin, lowest, highest, names, growth=None, area=None, **settings
):
    space = FreeSpace(obstacles, formation, margin, lowest, highest, growth, area)
    return search(space, start, goal, names=names, **settings)
