"""Least distance between neighbouring UAVs, along the line between their places in hover; one slack for all."""

import numpy as np

from idc_controller.control.constraints.constraint import StateConstraint
from idc_controller.control.settings import MpcSettings
from idc_controller.model.linear import LinearModel


class UavSeparation(StateConstraint):
    """It uses nothing of the limits: on the reference the links are parallel, and the UAVs as far apart as in hover."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        p = model.parameters
        hover = p.p - np.outer(p.l, [0.0, 0.0, 1.0])
        C = model.uav_position_rows
        apart = {(i, j): hover[i] - hover[j] for i in range(len(hover)) for j in range(i)}
        self.distance = p.separation(settings.separation_share)
        """Least distance between neighbours (m)."""
        rows, bounds = [], []
        for (i, j), d in apart.items():
            distance = float(np.linalg.norm(d))
            if distance < settings.neighbour_share * p.spacing + 1e-9:
                rows.append(-(d / distance) @ (C[3 * i : 3 * i + 3] - C[3 * j : 3 * j + 3]))
                bounds.append(max(distance - self.distance, 0.0))
        self.G, self.limits = np.array(rows), np.array(bounds)
        self.slack = np.zeros(len(rows), dtype=int)
