"""Physical parameters of the payload-UAV system (Table I of the paper), for any number of UAVs; the payload's hull."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array
from idc_controller.errors import ParameterError


@dataclass(frozen=True, eq=False)
class PayloadHull:
    """``vertices`` (V, 3) of the hull in the payload frame: forward-right-down about the centre of mass (m).

    Raises :class:`ParameterError` for vertices that enclose no volume, and for a centre of mass outside of them.
    """

    vertices: Array

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=float)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
            raise ParameterError("the payload's vertices must be finite, of shape (V, 3)")
        lower, upper = vertices.min(axis=0, initial=np.inf), vertices.max(axis=0, initial=-np.inf)
        if not (np.all(lower < 0.0) and np.all(upper > 0.0)):
            raise ParameterError(f"the payload must enclose its centre of mass; it reaches from {lower} to {upper} m")
        vertices.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)

    @classmethod
    def box(cls, size: ArrayLike) -> PayloadHull:
        """Return the hull of a box with edges ``size`` (3,) (m) about its centre."""
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return cls(signs * (np.asarray(size, dtype=float) / 2.0))

    @cached_property
    def bounds(self) -> Array:
        """Least and greatest coordinates of the level payload (2, 3) (m)."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @cached_property
    def below(self) -> float:
        """Depth of the level payload's lowest point below the centre of mass (m)."""
        return float(self.bounds[1, 2])

    @cached_property
    def above(self) -> float:
        """Height of the level payload's highest point above the centre of mass (m)."""
        return float(-self.bounds[0, 2])

    @cached_property
    def reach(self) -> float:
        """Radius of the ball about the centre of mass that holds the payload (m)."""
        return float(np.linalg.norm(self.vertices, axis=1).max())

    @cached_property
    def horizontal_reach(self) -> float:
        """Radius of the upright cylinder about the centre of mass that holds the level payload (m)."""
        return float(np.hypot(self.vertices[:, 0], self.vertices[:, 1]).max())

    @cached_property
    def areas(self) -> Array:
        """Areas of the silhouettes along the axes x, y, z (3,) (m2)."""
        from scipy.spatial import ConvexHull

        # The volume of a plane hull is its area.
        return np.array([ConvexHull(np.delete(self.vertices, axis, axis=1)).volume for axis in range(3)])

    @cached_property
    def box_edges(self) -> Array | None:
        """Edges (3,) (m) if the hull is a box along the axes about the centre of mass, else None."""
        edges = np.ptp(self.bounds, axis=0)
        is_box = len(self.vertices) == 8 and np.allclose(np.abs(self.vertices), edges / 2.0, rtol=0.0, atol=1e-9)
        return edges if is_box else None


@dataclass(frozen=True, eq=False)
class SystemParameters:
    """Payload, links and UAVs. SI units; payload and UAV frames are forward-right-down.

    The attributes carry the paper's symbols:

    - ``m_0`` payload mass (kg), ``J_0`` its inertia about the centre of mass (3, 3) (kg m2)
    - ``payload`` the payload's convex hull about its centre of mass
    - ``m`` UAV masses (N,) (kg), ``J`` their inertias (N, 3, 3) (kg m2)
    - ``p`` attachment points in the payload frame (N, 3) (m)
    - ``l`` link lengths (N,) (m)
    - ``disc_radius`` radius of the disc that covers a UAV's rotors (m)
    - ``thrust_max`` largest thrust of one UAV (N)
    - ``motor_time_constant`` of the first-order rotor-speed lag (s)
    - ``attitude_kp``, ``attitude_kd`` gains of the onboard attitude loop, torque = J (kp e - kd omega) (1/s2, 1/s)
    - ``g`` gravity (m/s2)

    Raises :class:`ParameterError` for shapes that do not agree and for values without a meaning.
    """

    m_0: float
    J_0: Array
    payload: PayloadHull
    m: Array
    J: Array
    p: Array
    l: Array  # the paper's symbol
    disc_radius: float
    thrust_max: float
    motor_time_constant: float
    attitude_kp: float
    attitude_kd: float
    g: float = 9.81

    def __post_init__(self) -> None:
        n = len(self.m)
        shapes = {"J_0": (3, 3), "m": (n,), "J": (n, 3, 3), "p": (n, 3), "l": (n,)}
        for name, shape in shapes.items():
            value = np.array(getattr(self, name), dtype=float)
            if value.shape != shape:
                raise ParameterError(f"{name} has shape {value.shape}, expected {shape}")
            if not np.all(np.isfinite(value)):
                raise ParameterError(f"{name} is not finite")
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        if n < 3:
            raise ParameterError(f"three UAVs or more hold a rigid payload level, not {n}")
        positive = {
            "m_0": self.m_0, "m": self.m, "l": self.l,
            "disc_radius": self.disc_radius, "thrust_max": self.thrust_max, "g": self.g,
            "motor_time_constant": self.motor_time_constant, "attitude_kp": self.attitude_kp,
            "attitude_kd": self.attitude_kd,
        }  # fmt: skip
        for name, number in positive.items():
            if not np.all(np.asarray(number) > 0.0):
                raise ParameterError(f"{name} must be positive, got {number}")
        for name, inertia in [("J_0", self.J_0), *((f"J[{i}]", J_i) for i, J_i in enumerate(self.J))]:
            if not np.allclose(inertia, inertia.T) or np.linalg.eigvalsh(inertia)[0] <= 0.0:
                raise ParameterError(f"{name} must be symmetric and positive definite")
        if np.linalg.matrix_rank(self._moment_balance()) < 3:
            raise ParameterError("the attachment points lie on one line: the payload would tip")
        share = self.payload_share
        if np.any(share <= 0.0):
            i = int(np.argmin(share))
            raise ParameterError(
                f"link {i + 1} would bear {100.0 * share[i]:.1f} % of the payload's weight (limit: more than 0): the "
                f"centre of mass lies too far to one side of the attachment points"
            )
        hover = self.hover_thrust
        if np.any(hover <= 0.0) or np.any(hover >= self.thrust_max):
            raise ParameterError(
                f"hover needs {np.max(hover):.1f} N of one UAV (limit: less than its largest thrust, "
                f"{self.thrust_max:g} N)"
            )

    @property
    def number_of_uavs(self) -> int:
        """Number of UAVs, N."""
        return len(self.m)

    @cached_property
    def m_T(self) -> float:
        """Mass of payload and UAVs together (kg), the paper's m_T."""
        return float(self.m_0 + self.m.sum())

    @cached_property
    def payload_share(self) -> Array:
        """Share of the payload's weight that each link bears at hover, (N,), summing to one.

        The least-norm solution of force and moment balance; 1/N each for a symmetric layout.
        """
        return np.asarray(np.linalg.pinv(self._moment_balance()) @ np.array([1.0, 0.0, 0.0]))

    @cached_property
    def hover_thrust(self) -> Array:
        """Thrust of each UAV at the equilibrium eq:EqPt (N,) (N), corrected to hold for any layout."""
        return (self.m + self.m_0 * self.payload_share) * self.g

    @cached_property
    def spacing(self) -> float:
        """Least distance between two UAVs in hover (m)."""
        hover = self.p - np.outer(self.l, [0.0, 0.0, 1.0])
        return min(float(np.linalg.norm(hover[i] - hover[j])) for i in range(len(hover)) for j in range(i))

    def separation(self, share: float) -> float:
        """Return the UAV separation (m) at which ``share`` of the gap between neighbouring discs in hover remains."""
        discs = 2.0 * self.disc_radius
        return discs + share * (self.spacing - discs)

    def with_payload_mass(self, m_0: float) -> SystemParameters:
        """Return the system with another payload mass (kg); the inertia scales with it."""
        return replace(self, m_0=m_0, J_0=self.J_0 * (m_0 / self.m_0))

    def _moment_balance(self) -> Array:
        """Rows: sum of shares, moments about x and y of unit vertical loads at the attachment points."""
        return np.vstack([np.ones(len(self.p)), self.p[:, 1], -self.p[:, 0]])


def polygon_attachments(number_of_uavs: int, side: float, height: float) -> Array:
    """Attachment points on a regular polygon, (N, 3) in the payload frame (m).

    ``side`` is the distance between neighbours (m), so that UAVs of any number keep the same distance; ``height``
    is the points' z in the payload frame (m, negative: above the centre). For four UAVs, ``side`` 1.0 and ``height``
    -0.25 these are the corners of the paper's Table I, in its order.
    """
    radius = side / (2.0 * np.sin(np.pi / number_of_uavs))
    # UAV 1 is front right; the rest follow against the sense of the yaw angle, as in Table I.
    angle = np.pi / number_of_uavs - 2.0 * np.pi * np.arange(number_of_uavs) / number_of_uavs
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(number_of_uavs, height)]).round(12)
