"""The errors of the simulated world."""


class SimulationError(Exception):
    """Root of every error raised by ``vehicle_sim``."""


class UnsupportedWorld(SimulationError):
    """A world that the physics engine would compute wrongly (too many vehicles, ...)."""
