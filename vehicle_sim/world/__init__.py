"""The simulated world: physics engine, sensors, obstacles, true motion."""
