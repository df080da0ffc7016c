"""The errors of the mathematics."""


class IdcError(Exception):
    """Root of every error raised by ``idc_controller``."""


class ParameterError(IdcError):
    """A physical or tuning parameter has no meaning (negative mass, wrong shape, ...)."""


class SolverError(IdcError):
    """A solver ended without a usable solution."""


class TrajectoryError(IdcError):
    """No trajectory satisfies the demands (too few points, limits that are not positive, ...)."""


class ShapeError(IdcError):
    """A shape that does not exist, or one whose lengths have no meaning."""
